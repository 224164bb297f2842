// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/rtps/common/SerializedPayload.h>
#include <fastdds/dds/topic/TopicDataType.hpp>

#include <cstring>
#include <type_traits>

#include "common/bus/message_copy.hpp"

namespace rtd::bus::fastdds {

/// Type support of a plain struct whose bytes in memory are its XCDR1 bytes on the wire (little endian):
/// (de)serialising is one memcpy, where generated code would walk through up to 30,000 fields.
template <class T>
class PlainType : public eprosima::fastdds::dds::TopicDataType {
 public:
  static_assert(std::is_trivially_copyable_v<T> && std::is_standard_layout_v<T>);
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  static constexpr std::uint32_t kHeaderBytes = Payload::representation_header_size;
  static constexpr std::uint32_t kWireBytes = kHeaderBytes + sizeof(T);

  explicit PlainType(const char* dds_name) {
    setName(dds_name);
    m_typeSize = kWireBytes;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }

  bool serialize(void* data, Payload* payload) override {
    if (payload->max_size < kWireBytes) return false;
    payload->encapsulation = CDR_LE;
    constexpr unsigned char kCdrLittleEndian[kHeaderBytes] = {0, 1, 0, 0};
    std::memcpy(payload->data, kCdrLittleEndian, kHeaderBytes);
    copy_message(payload->data + kHeaderBytes, data, sizeof(T));
    payload->length = kWireBytes;
    return true;
  }
  bool deserialize(Payload* payload, void* data) override {
    const bool little_endian = payload->length >= kHeaderBytes && payload->data[1] == 1;
    if (!little_endian || payload->length < kWireBytes) return false;
    copy_message(data, payload->data + kHeaderBytes, sizeof(T));
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void*) override {
    return [] { return kWireBytes; };
  }
  void* createData() override { return new T; }
  void deleteData(void* data) override { delete static_cast<T*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
  bool is_bounded() const override { return true; }
  bool is_plain() const override { return true; }
};

}  // namespace rtd::bus::fastdds
