// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/codec.hpp"

#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "common/bus/fastdds/message_type.hpp"
#include "common/bus/message_pool.hpp"

namespace rtd::bus::fastdds {
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

template <class T>
class MessageCodec : public Codec {
 public:
  bool plain() const override { return kPlain; }
  dds::TypeSupport create_type() const override { return dds::TypeSupport(new MessageType<T>); }
  bool write(dds::DataWriter& writer, const void* message) const override {
    return writer.write(const_cast<void*>(message));  // the vendor only reads it
  }
  TakenSample take(dds::DataReader& reader) override;
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

/// Copies the sample out, never takes it as a loan. With data sharing the sample lies in the writer's own ring, which
/// the writer overwrites and at its end unmaps whenever it likes. Fast DDS copies under its lock, which keeps the ring
/// mapped, and refuses the sample when it finds it overwritten after the copy.
template <class T>
TakenSample MessageCodec<T>::take(dds::DataReader& reader) {
  std::shared_ptr<T> message = create();
  dds::SampleInfo info;
  if (reader.take_next_sample(message.get(), &info) != ReturnCode_t::RETCODE_OK) return {};
  if (!info.valid_data) return {TakenSample::Kind::kNoData, nullptr};
  if (!msg::is_plausible(*message)) return {TakenSample::Kind::kUnusable, nullptr};
  return {TakenSample::Kind::kMessage, std::move(message)};
}

}  // namespace

std::unique_ptr<Codec> create_codec(MessageId id) {
  return visit_message_type(id,
                            []<class T>() -> std::unique_ptr<Codec> { return std::make_unique<MessageCodec<T>>(); });
}

}  // namespace rtd::bus::fastdds
