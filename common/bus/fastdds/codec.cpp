// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/codec.hpp"

#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "common/bus/fastdds/converted_type.hpp"
#include "common/bus/fastdds/plain_type.hpp"
#include "common/bus/message_pool.hpp"
#include "common/bus/message_visit.hpp"
#include "common/bus/plausible.hpp"
#include "common/bus/type_names.hpp"

namespace rtd::bus::fastdds {
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

/// Fixed-size messages: the plain struct itself goes through the bus.
template <class T>
class PlainCodec : public Codec {
 public:
  bool plain() const override { return true; }
  dds::TypeSupport create_type() const override {
    return dds::TypeSupport(new PlainType<T>(dds_type_name(MessageTraits<T>::kId)));
  }
  bool write(dds::DataWriter& writer, const void* message) const override {
    return writer.write(const_cast<void*>(message));  // the vendor only reads it
  }
  TakenSample take(dds::DataReader& reader) override;
  bool in_place() const override { return alignof(T) <= PlainType<T>::kHeaderBytes; }
  std::shared_ptr<void> allocate() const override { return pool_.acquire(); }

 private:
  MessagePool<T> pool_;
};

/// Copies the sample out, never takes it as a loan. With data sharing the sample lies in the writer's own ring, which
/// the writer overwrites and at its end unmaps whenever it likes. Fast DDS copies under its lock, which keeps the ring
/// mapped, and refuses the sample when it finds it overwritten after the copy.
template <class T>
TakenSample PlainCodec<T>::take(dds::DataReader& reader) {
  std::shared_ptr<T> copy = pool_.acquire();
  dds::SampleInfo info;
  if (reader.take_next_sample(copy.get(), &info) != ReturnCode_t::RETCODE_OK) return {};
  if (!info.valid_data) return {TakenSample::Kind::kNoData, nullptr};
  if (!is_plausible(*copy)) return {TakenSample::Kind::kUnusable, nullptr};
  return {TakenSample::Kind::kMessage, std::move(copy)};
}

/// Messages of variable size: converted to and from the generated type.
template <class T>
class ConvertedCodec : public Codec {
 public:
  bool plain() const override { return false; }
  dds::TypeSupport create_type() const override { return dds::TypeSupport(new SafeType<T>); }
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
