// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/rtps/common/SerializedPayload.h>

#include <cstring>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <span>

#include "common/bus/raw_bus.hpp"

namespace rtd::bus::fastdds {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

/// What Fast DDS hands to the type support: one side of it is in use.
struct RawData {
  std::span<const std::byte> output;
  ByteBlock* input = nullptr;
};

/// Passes the serialised sample on as it is, whatever its type.
class RawType : public dds::TopicDataType {
 public:
  using Payload = rtps::SerializedPayload_t;

  RawType(const RawTopic& topic, bool bounded, std::uint32_t fixed_bytes) : bounded_(bounded) {
    constexpr std::uint32_t kFirstGuess = 1024;       // memory grows with the samples
    constexpr std::uint32_t kMaxInPlace = 64 << 20;   // the size is not announced; a larger sample would be refused
    setName(topic.type.c_str());
    m_typeSize = fixed_bytes > 0 ? fixed_bytes : (bounded ? kMaxInPlace : kFirstGuess);
    m_isGetKeyDefined = topic.keyed;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }

  bool serialize(void* data, Payload* payload) override {
    const std::span<const std::byte> cdr = static_cast<const RawData*>(data)->output;
    if (payload->max_size < cdr.size()) return false;
    payload->encapsulation = (std::to_integer<unsigned>(cdr[1]) & 1U) != 0 ? CDR_LE : CDR_BE;
    std::memcpy(payload->data, cdr.data(), cdr.size());
    payload->length = static_cast<std::uint32_t>(cdr.size());
    return true;
  }
  bool deserialize(Payload* payload, void* data) override {
    ByteBlock* const block = static_cast<RawData*>(data)->input;
    if (block == nullptr) return false;
    block->assign(std::as_bytes(std::span(payload->data, payload->length)));
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [size = static_cast<std::uint32_t>(static_cast<const RawData*>(data)->output.size())] { return size; };
  }
  void* createData() override { return new RawData; }
  void deleteData(void* data) override { delete static_cast<RawData*>(data); }
  /// One instance for all keys: which bytes are the key is not known.
  bool getKey(void*, rtps::InstanceHandle_t* handle, bool) override {
    const rtps::octet kOnlyInstance[16] = {1};
    for (int i = 0; i < 16; ++i) handle->value[i] = kOnlyInstance[i];
    return true;
  }
  bool is_bounded() const override { return bounded_; }
  bool is_plain() const override { return bounded_; }

 private:
  const bool bounded_;  // what shared memory asks for
};

}  // namespace rtd::bus::fastdds
