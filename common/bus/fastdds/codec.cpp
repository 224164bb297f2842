// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/codec.hpp"

#include <algorithm>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <optional>

#include "common/bus/fastdds/message_type.hpp"
#include "common/bus/message_pool.hpp"
#include "common/msg/largest_sample.hpp"

namespace rtd::bus::fastdds {
namespace {

template <class T>
class MessageCodec : public Codec {
 public:
  bool plain() const override { return kPlain; }
  std::size_t largest_sample() const override { return msg::largest_sample<T>(); }
  dds::TypeSupport create_type() const override { return dds::TypeSupport(new MessageType<T>); }
  std::size_t sample_size(const void* message) const override { return cdr_size(*static_cast<const T*>(message)); }
  bool write(dds::DataWriter& writer, const void* message) const override {
    return succeeded(writer.write(const_cast<void*>(message)));  // the vendor only reads it
  }
  TakenSample take(dds::DataReader& reader, const Accepts& accepts) override;
  bool in_place() const override { return kPlain && alignof(T) <= sizeof(kCdrHeader); }
  std::shared_ptr<void> allocate() const override {
    if (!kPlain) throw BusError(create_type().get_type_name() + " is of variable size and cannot be loaned");
    return create();
  }

 private:
  static constexpr bool kPlain = MessageTraits<T>::kPlain;
  struct NoPool {};

  std::shared_ptr<T> create() const {
    if constexpr (kPlain) {
      return pool_.acquire();
    } else {
      return std::make_shared<T>();
    }
  }

  std::conditional_t<kPlain, MessagePool<T>, NoPool> pool_;
};

/// Whether the next sample is wanted, by its writer alone.
class NextWanted {
 public:
  NextWanted(dds::DataReader& reader, const Codec::Accepts& accepts) : accepts_(accepts) {
    dds::SampleInfo next;
    if (!accepts_ || !succeeded(reader.get_first_untaken_info(&next))) return;
    writer_ = to_writer_id(next.sample_identity.writer_guid());
    wanted_ = accepts_(*writer_);
  }
  bool wanted() const { return wanted_; }
  /// For the one that was taken then: another one may have become the next meanwhile.
  bool wanted(const WriterId& taken) const { return !accepts_ || (taken == writer_ ? wanted_ : accepts_(taken)); }

 private:
  const Codec::Accepts& accepts_;
  std::optional<WriterId> writer_;
  bool wanted_ = true;
};

/// Copies the sample out, never takes it as a loan. With data sharing the sample lies in the writer's own ring, which
/// the writer overwrites and at its end unmaps whenever it likes. Fast DDS copies under its lock, which keeps the ring
/// mapped, and refuses the sample when it finds it overwritten after the copy.
template <class T>
TakenSample MessageCodec<T>::take(dds::DataReader& reader, const Accepts& accepts) {
  constexpr std::size_t kCheapToCopy = 500'000;  // bytes
  const NextWanted next(reader, accepts);
  std::shared_ptr<T> message = next.wanted() || sizeof(T) < kCheapToCopy ? create() : nullptr;
  dds::SampleInfo info;
  if (!succeeded(reader.take_next_sample(message.get(), &info))) return {};
  const WriterId writer = to_writer_id(info.sample_identity.writer_guid());
  if (!info.valid_data || !next.wanted(writer)) return {TakenSample::Kind::kNoData};
  if (message == nullptr) return {TakenSample::Kind::kUnusable};
  return {TakenSample::Kind::kMessage, std::move(message), writer};
}

class RawCodec : public Codec {
 public:
  /// `largest` 0: as the topic has it.
  RawCodec(RawTopic topic, bool bounded, std::uint32_t fixed_bytes, std::size_t largest = 0)
      : topic_(std::move(topic)),
        bounded_(bounded),
        fixed_bytes_(fixed_bytes),
        largest_(largest > 0 ? largest : bus::largest_sample(topic_)) {}

  bool plain() const override { return bounded_; }
  std::size_t largest_sample() const override { return largest_; }
  dds::TypeSupport create_type() const override {
    return dds::TypeSupport(new RawType(topic_, bounded_, fixed_bytes_));
  }
  bool write(dds::DataWriter& writer, const void* message) const override;
  TakenSample take(dds::DataReader& reader, const Accepts& accepts) override;
  std::shared_ptr<void> allocate() const override { throw BusError("a raw writer lends no memory"); }

 private:
  const RawTopic topic_;
  const bool bounded_;
  const std::uint32_t fixed_bytes_;
  const std::size_t largest_;
  MessagePool<ByteBlock> pool_;
};

bool RawCodec::write(dds::DataWriter& writer, const void* message) const {
  const RawOutput& output = *static_cast<const RawOutput*>(message);
  const bool right_size = fixed_bytes_ == 0 || output.cdr.size() == fixed_bytes_;
  if (output.cdr.size() < ByteBlock::kCdrHeaderBytes || !right_size) return false;
  RawData data{output.cdr, nullptr};
  if (output.source_ns == 0) return succeeded(writer.write(&data));
  rtps::WriteParams params;
  params.source_timestamp().from_ns(output.source_ns);
  return succeeded(writer.write(&data, params));
}

std::int64_t known_or(const rtps::Time_t& time, std::int64_t fallback_ns) {
  const bool known = time.seconds() > 0 && time != rtps::c_RTPSTimeInfinite && time != rtps::c_RTPSTimeInvalid;
  return known ? time.to_ns() : fallback_ns;
}

std::int64_t now_ns() {
  rtps::Time_t now;
  rtps::Time_t::now(now);
  return now.to_ns();
}

TakenSample RawCodec::take(dds::DataReader& reader, const Accepts&) {
  auto block = pool_.acquire();
  RawData data{{}, block.get()};
  dds::SampleInfo info;
  if (!succeeded(reader.take_next_sample(&data, &info))) return {};
  auto sample = std::make_shared<RawSample>();
  sample->writer = to_writer_id(info.sample_identity.writer_guid());
  sample->sequence = static_cast<std::int64_t>(info.sample_identity.sequence_number().to64long());
  sample->received_ns = known_or(info.reception_timestamp, now_ns());
  sample->source_ns = known_or(info.source_timestamp, sample->received_ns);
  // A dispose or the like has a number too: without it the next sample would seem to be missing.
  if (info.valid_data) sample->bytes = std::move(block);
  return {TakenSample::Kind::kMessage, std::move(sample)};  // it names its writer
}

}  // namespace

std::unique_ptr<Codec> create_codec(MessageId id) {
  return visit_message_type(id,
                            []<class T>() -> std::unique_ptr<Codec> { return std::make_unique<MessageCodec<T>>(); });
}

std::unique_ptr<Codec> create_raw_codec(const RawTopic& topic, const RawReaderOptions& options) {
  return std::make_unique<RawCodec>(topic, options.in_place, 0, options.largest_sample);
}

std::unique_ptr<Codec> create_raw_codec(const RawTopic& topic, const RawWriterOptions& options) {
  return std::make_unique<RawCodec>(topic, options.fixed_bytes > 0, options.fixed_bytes);
}

WriterId to_writer_id(const rtps::GUID_t& guid) {
  WriterId id{};
  std::copy_n(guid.guidPrefix.value, rtps::GuidPrefix_t::size, id.begin());
  std::copy_n(guid.entityId.value, rtps::EntityId_t::size, id.begin() + rtps::GuidPrefix_t::size);
  return id;
}

}  // namespace rtd::bus::fastdds
