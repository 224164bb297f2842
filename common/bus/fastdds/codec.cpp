// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/codec.hpp"

#include <fastdds/dds/core/LoanableSequence.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "common/bus/fastdds/converted_type.hpp"
#include "common/bus/fastdds/message_pool.hpp"
#include "common/bus/fastdds/plain_type.hpp"
#include "common/bus/message_visit.hpp"

namespace rtd::bus::fastdds {
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

template <class T>
constexpr const char* kPlainTypeName = nullptr;
template <>
constexpr const char* kPlainTypeName<msg::RgbdFrame> = "rtd_msgs::msg::dds_::RgbdFrame_";
template <>
constexpr const char* kPlainTypeName<msg::FeatureFrame> = "rtd_msgs::msg::dds_::FeatureFrame_";
template <>
constexpr const char* kPlainTypeName<msg::KeyframeEvent> = "rtd_msgs::msg::dds_::KeyframeEvent_";
template <>
constexpr const char* kPlainTypeName<msg::TrackingResult> = "rtd_msgs::msg::dds_::TrackingResult_";

/// Fixed-size messages: the plain struct itself goes through the bus.
template <class T>
class PlainCodec : public Codec {
 public:
  bool plain() const override { return true; }
  dds::TypeSupport create_type() const override { return dds::TypeSupport(new PlainType<T>(kPlainTypeName<T>)); }
  bool write(dds::DataWriter& writer, const void* message) const override {
    return writer.write(const_cast<void*>(message));  // the vendor only reads it
  }
  TakenSample take(dds::DataReader& reader) override;
  std::shared_ptr<void> allocate() const override { return pool_.acquire(); }

 private:
  MessagePool<T> pool_;
};

/// Copies first and asks then whether the writer has overwritten the sample meanwhile: with data sharing the loaned
/// memory is the writer's own ring, and nothing keeps it from going on.
template <class T>
TakenSample PlainCodec<T>::take(dds::DataReader& reader) {
  dds::LoanableSequence<T> samples;
  dds::SampleInfoSeq infos;
  if (reader.take(samples, infos, 1) != ReturnCode_t::RETCODE_OK) return {};
  TakenSample taken{TakenSample::Kind::kNoData, nullptr};
  if (infos.length() > 0 && infos[0].valid_data) {
    const void* loaned = samples.buffer()[0];  // not aligned for T: it follows the 4-byte CDR header
    std::shared_ptr<T> copy = pool_.acquire();
    std::memcpy(copy.get(), loaned, sizeof(T));
    if (reader.is_sample_valid(loaned, &infos[0])) {
      taken = {TakenSample::Kind::kMessage, std::move(copy)};
    } else {
      taken.kind = TakenSample::Kind::kTorn;
    }
  }
  reader.return_loan(samples, infos);
  return taken;
}

/// Messages of variable size: converted to and from the generated type.
template <class T>
class ConvertedCodec : public Codec {
 public:
  bool plain() const override { return false; }
  dds::TypeSupport create_type() const override { return dds::TypeSupport(new typename ConvertedType<T>::PubSub); }
  bool write(dds::DataWriter& writer, const void* message) const override {
    VendorOf<T> vendor;
    ToVendor{}(*static_cast<const T*>(message), vendor);
    return writer.write(&vendor);
  }
  TakenSample take(dds::DataReader& reader) override {
    dds::SampleInfo info;
    if (reader.take_next_sample(&received_, &info) != ReturnCode_t::RETCODE_OK) return {};
    if (!info.valid_data) return {TakenSample::Kind::kNoData, nullptr};
    auto message = std::make_shared<T>();
    FromVendor{}(*message, received_);
    return {TakenSample::Kind::kMessage, std::move(message)};
  }
  std::shared_ptr<void> allocate() const override {
    throw BusError(create_type().get_type_name() + " is of variable size and cannot be loaned");
  }

 private:
  VendorOf<T> received_;
};

}  // namespace

std::unique_ptr<Codec> create_codec(MessageId id) {
  return visit_message_type(id, []<class T>() -> std::unique_ptr<Codec> {
    if constexpr (MessageTraits<T>::kPlain) {
      return std::make_unique<PlainCodec<T>>();
    } else {
      return std::make_unique<ConvertedCodec<T>>();
    }
  });
}

}  // namespace rtd::bus::fastdds
