// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/rtps/common/SerializedPayload.h>

#include <array>
#include <cstring>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/bus/backend.hpp"
#include "common/bus/message_cdr.hpp"
#include "common/bus/raw_bus.hpp"

namespace rtd::bus::fastdds {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

/// Adds the largest T to the size of a sample, as fastddsgen counts it for a type without bounds: texts of 255 letters,
/// sequences of 100 elements.
struct LargestSample {
  std::size_t size = 0;

  template <class T>
  void add() {
    if constexpr (msg::Message<T>) {
      msg::for_each_field_type<T>([this]<class Field>(const char*) { add<Field>(); });
    } else if constexpr (std::is_class_v<T>) {
      add_many(msg::TypeOf<T>());
    } else {
      size = (size + sizeof(T) - 1) / sizeof(T) * sizeof(T) + sizeof(T);
    }
  }

 private:
  void add_many(msg::TypeOf<std::string>) {
    add<std::uint32_t>();
    size += 255 + 1;
  }
  template <class T>
  void add_many(msg::TypeOf<std::vector<T>>) {
    add<std::uint32_t>();
    for (int i = 0; i < 100; ++i) add<T>();
  }
  template <class T, std::size_t kSize>
  void add_many(msg::TypeOf<std::array<T, kSize>>) {
    for (std::size_t i = 0; i < kSize; ++i) add<T>();
  }
};

/// The type support of a message, by its list of fields; that of a plain one is one memcpy. Fast DDS gives its peers
/// the size of the largest sample; where there is none, that of generated code stays.
template <class T>
class MessageType : public dds::TopicDataType {
 public:
  static constexpr bool kPlain = MessageTraits<T>::kPlain;
  static constexpr std::uint32_t kHeaderBytes = sizeof(kCdrHeader);
  using Payload = rtps::SerializedPayload_t;

  MessageType() {
    setName(dds_type_name(MessageTraits<T>::kId).c_str());
    m_typeSize = largest_sample();
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }

  bool serialize(void* data, Payload* payload) override {
    const T& message = *static_cast<const T*>(data);
    const std::size_t written = write_cdr(message, {payload->data, payload->max_size});
    payload->encapsulation = CDR_LE;
    payload->length = static_cast<std::uint32_t>(written);
    return written > 0;
  }
  /// Without `data` the sample is not wanted and stays unread.
  bool deserialize(Payload* payload, void* data) override {
    return data == nullptr || read_cdr({payload->data, payload->length}, *static_cast<T*>(data));
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(cdr_size(*static_cast<const T*>(data))); };
  }
  void* createData() override { return new T; }
  void deleteData(void* data) override { delete static_cast<T*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
  bool is_bounded() const override { return kPlain; }
  bool is_plain() const override { return kPlain; }

 private:
  static std::uint32_t largest_sample() {
    if constexpr (kPlain) {
      return kHeaderBytes + sizeof(T);
    } else {
      LargestSample largest;
      largest.add<T>();
      return static_cast<std::uint32_t>((largest.size + 3) / 4 * 4 + kHeaderBytes);
    }
  }
};

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
    constexpr std::uint32_t kFirstGuess = 1024;      // memory grows with the samples
    constexpr std::uint32_t kMaxInPlace = 64 << 20;  // the size is not announced; a larger sample would be refused
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
