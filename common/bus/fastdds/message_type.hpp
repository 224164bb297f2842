// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "common/bus/backend.hpp"
#include "common/bus/fastdds/versions/vendor.hpp"
#include "common/bus/message_cdr.hpp"
#include "common/bus/raw_bus.hpp"

namespace rtd::bus::fastdds {

/// Adds the largest T to the size of a sample, as fastddsgen counts it for a type without bounds: texts of 255 letters,
/// sequences of 100 elements.
struct LargestSample {
  std::size_t size = 0;

  template <class T>
  void add() {
    if constexpr (msg::Message<T>) {
      msg::for_each_field_type<T>([this]<class Field>(const char*) { this->template add<Field>(); });
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
class MessageType : public TypeSupportBase {
 public:
  static constexpr bool kPlain = MessageTraits<T>::kPlain;
  static constexpr std::uint32_t kHeaderBytes = sizeof(kCdrHeader);

  MessageType() : TypeSupportBase(dds_type_name(MessageTraits<T>::kId), largest_sample(), false) {}

  std::size_t write(const void* data, std::span<std::uint8_t> to) const override {
    return write_cdr(*static_cast<const T*>(data), to);
  }
  /// Without `data` the sample is not wanted and stays unread.
  bool read(std::span<const std::uint8_t> cdr, void* data) const override {
    return data == nullptr || read_cdr(cdr, *static_cast<T*>(data));
  }
  std::uint32_t size_of(const void* data) const override {
    return static_cast<std::uint32_t>(cdr_size(*static_cast<const T*>(data)));
  }
  void* create() const override { return new T; }
  void destroy(void* data) const override { delete static_cast<T*>(data); }
  bool plain() const override { return kPlain; }

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
class RawType : public TypeSupportBase {
 public:
  RawType(const RawTopic& topic, bool bounded, std::uint32_t fixed_bytes)
      : TypeSupportBase(topic.type, fixed_bytes > 0 ? fixed_bytes : kFirstGuess, topic.keyed), bounded_(bounded) {}

  std::size_t write(const void* data, std::span<std::uint8_t> to) const override {
    const std::span<const std::byte> cdr = static_cast<const RawData*>(data)->output;
    if (to.size() < cdr.size()) return 0;
    std::memcpy(to.data(), cdr.data(), cdr.size());
    return cdr.size();
  }
  bool read(std::span<const std::uint8_t> cdr, void* data) const override {
    ByteBlock* const block = static_cast<RawData*>(data)->input;
    if (block == nullptr) return false;
    block->assign(std::as_bytes(cdr));
    return true;
  }
  std::uint32_t size_of(const void* data) const override {
    return static_cast<std::uint32_t>(static_cast<const RawData*>(data)->output.size());
  }
  void* create() const override { return new RawData; }
  void destroy(void* data) const override { delete static_cast<RawData*>(data); }
  bool plain() const override { return bounded_; }

 private:
  static constexpr std::uint32_t kFirstGuess = 1024;  // of writers, whose memory grows with the samples
  const bool bounded_;                                // what shared memory asks for
};

}  // namespace rtd::bus::fastdds
