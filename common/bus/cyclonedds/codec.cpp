// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/codec.hpp"

#include <cstring>

#include "common/bus/backend.hpp"
#include "common/bus/message_cdr.hpp"
#include "common/msg/largest_sample.hpp"

namespace rtd::bus::cyclonedds {
namespace {

constexpr std::size_t kHeader = sizeof(kCdrHeader);

ros::Bytes bytes_of(const ByteBlock& block) {
  const auto sample = block.view();
  return {reinterpret_cast<const std::uint8_t*>(sample.data()), sample.size()};
}

/// The sample itself is the message: no copy.
template <class T>
std::shared_ptr<const void> decode_plain(const std::shared_ptr<const ByteBlock>& bytes) {
  static_assert(alignof(T) <= 16, "ByteBlock aligns to 16");
  const ros::Bytes sample = bytes_of(*bytes);
  if (!is_plain_cdr<T>(sample)) return nullptr;
  return {bytes, sample.data() + kHeader};
}

template <class T>
std::shared_ptr<const void> decode_fields(const ByteBlock& bytes) {
  auto message = std::make_shared<T>();
  return read_cdr(bytes_of(bytes), *message) ? message : nullptr;
}

}  // namespace

SampleType sample_type(MessageId id) {
  const std::uint32_t plain_bytes =
      visit_message_type(id, []<class T>() -> std::uint32_t { return MessageTraits<T>::kPlain ? sizeof(T) : 0; });
  const std::size_t largest = visit_message_type(id, []<class T>() { return msg::largest_sample<T>(); });
  return {dds_type_name(id), false, plain_bytes, false, largest};
}

std::shared_ptr<ByteBlock> plain_block(MessageId id, const ddsi_sertype* type) {
  const std::uint32_t size = sample_type(id).plain_bytes;
  if (size == 0) throw BusError(dds_type_name(id) + " is of variable size and cannot be loaned");
  auto block = acquire_block(type, kHeader + size);
  std::memcpy(block->bytes().data(), kCdrHeader, kHeader);
  return block;
}

std::shared_ptr<ByteBlock> encode(MessageId id, const ddsi_sertype* type, const void* message) {
  return visit_message_type(id, [&]<class T>() {
    const T& typed = *static_cast<const T*>(message);
    auto block = acquire_block(type, cdr_size(typed));
    const auto bytes = block->bytes();
    write_cdr(typed, {reinterpret_cast<std::uint8_t*>(bytes.data()), bytes.size()});
    return block;
  });
}

std::shared_ptr<const void> decode(MessageId id, const std::shared_ptr<const ByteBlock>& bytes) {
  return visit_message_type(id, [&]<class T>() -> std::shared_ptr<const void> {
    if constexpr (MessageTraits<T>::kPlain) {
      return decode_plain<T>(bytes);
    } else {
      return decode_fields<T>(*bytes);
    }
  });
}

}  // namespace rtd::bus::cyclonedds
