// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/codec.hpp"

#include <cstring>

#include "common/bus/cyclonedds/sample_io.hpp"
#include "common/bus/message_visit.hpp"
#include "common/bus/plausible.hpp"
#include "common/bus/type_names.hpp"
#include "common/ros_codec/wire_reader.hpp"
#include "common/ros_codec/wire_rtd.hpp"
#include "common/ros_codec/wire_writer.hpp"

namespace rtd::bus::cyclonedds {
namespace {

constexpr std::size_t kHeader = ByteBlock::kCdrHeaderBytes;
constexpr std::byte kLittleEndianCdr[kHeader] = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};

/// The sample itself is the message: no copy.
template <class T>
std::shared_ptr<const void> decode_plain(const std::shared_ptr<const ByteBlock>& bytes) {
  static_assert(alignof(T) <= 16, "ByteBlock aligns to 16");
  const auto sample = bytes->view();
  if (sample.size() < kHeader + sizeof(T) || std::memcmp(sample.data(), kLittleEndianCdr, 2) != 0) return nullptr;
  const auto* const message = reinterpret_cast<const T*>(sample.data() + kHeader);
  return is_plausible(*message) ? std::shared_ptr<const void>(bytes, message) : nullptr;
}

template <class T>
std::shared_ptr<const void> decode_fields(const std::shared_ptr<const ByteBlock>& bytes) try {
  const auto sample = bytes->view();
  return std::make_shared<T>(
      ros::decode<T>(ros::Wire::kCdr, {reinterpret_cast<const std::uint8_t*>(sample.data()), sample.size()}));
} catch (const ros::WireError&) {
  return nullptr;
}

}  // namespace

SampleType sample_type(MessageId id) {
  const std::uint32_t plain_bytes =
      visit_message_type(id, []<class T>() -> std::uint32_t { return MessageTraits<T>::kPlain ? sizeof(T) : 0; });
  return {dds_type_name(id), false, plain_bytes, false};
}

std::shared_ptr<ByteBlock> plain_block(MessageId id, const ddsi_sertype* type) {
  const std::uint32_t size = sample_type(id).plain_bytes;
  if (size == 0) throw BusError(std::string(dds_type_name(id)) + " is of variable size and cannot be loaned");
  auto block = acquire_block(type, kHeader + size);
  std::memcpy(block->bytes().data(), kLittleEndianCdr, kHeader);
  return block;
}

std::shared_ptr<ByteBlock> encode(MessageId id, const ddsi_sertype* type, const void* message) {
  return visit_message_type(id, [&]<class T>() {
    if constexpr (MessageTraits<T>::kPlain) {
      auto block = plain_block(id, type);
      std::memcpy(block->bytes().data() + kHeader, message, sizeof(T));
      return block;
    } else {
      const auto bytes = ros::encode<ros::Wire::kCdr>(*static_cast<const T*>(message));
      auto block = acquire_block(type, bytes.size());
      block->assign(std::as_bytes(std::span(bytes)));
      return block;
    }
  });
}

std::shared_ptr<const void> decode(MessageId id, const std::shared_ptr<const ByteBlock>& bytes) {
  return visit_message_type(id, [&]<class T>() -> std::shared_ptr<const void> {
    if constexpr (MessageTraits<T>::kPlain) {
      return decode_plain<T>(bytes);
    } else {
      return decode_fields<T>(bytes);
    }
  });
}

}  // namespace rtd::bus::cyclonedds
