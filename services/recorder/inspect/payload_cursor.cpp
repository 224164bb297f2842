// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/payload_cursor.hpp"

#include <fmt/format.h>

#include <cstring>

namespace rtd::recording {
namespace {

template <class T>
T number(mcap::ByteView value) {
  T result{};
  if (value.size() == sizeof(T)) std::memcpy(&result, value.data(), sizeof(T));
  return result;
}

}  // namespace

std::size_t size_of(FieldKind kind) {
  switch (kind) {
    case FieldKind::kU8:
      return 1;
    case FieldKind::kI16:
    case FieldKind::kU16:
      return 2;
    case FieldKind::kI64:
    case FieldKind::kU64:
    case FieldKind::kF64:
      return 8;
    default:
      return 4;
  }
}

std::string value_text(FieldKind kind, mcap::ByteView value) {
  switch (kind) {
    case FieldKind::kU8:
      return std::to_string(number<std::uint8_t>(value));
    case FieldKind::kI16:
      return std::to_string(number<std::int16_t>(value));
    case FieldKind::kU16:
      return std::to_string(number<std::uint16_t>(value));
    case FieldKind::kI32:
      return std::to_string(number<std::int32_t>(value));
    case FieldKind::kU32:
      return std::to_string(number<std::uint32_t>(value));
    case FieldKind::kI64:
      return std::to_string(number<std::int64_t>(value));
    case FieldKind::kU64:
      return std::to_string(number<std::uint64_t>(value));
    case FieldKind::kF32:
      return fmt::format("{}", number<float>(value));
    case FieldKind::kF64:
      return fmt::format("{}", number<double>(value));
    case FieldKind::kText:
      break;
  }
  return '"' + std::string(reinterpret_cast<const char*>(value.data()), value.size()) + '"';
}

PayloadCursor::PayloadCursor(mcap::ByteView payload) : payload_(payload) {
  ok_ = payload.size() >= kHeaderBytes && payload[1] == std::byte{1};  // CDR_LE
}

mcap::ByteView PayloadCursor::bytes(std::size_t count) {
  if (!ok_ || count > payload_.size() - position_) {
    ok_ = false;
    return {};
  }
  position_ += count;
  return payload_.subspan(position_ - count, count);
}

mcap::ByteView PayloadCursor::take(FieldKind kind) {
  bytes(padding(position_, size_of(kind)));
  const mcap::ByteView value = bytes(size_of(kind));
  if (kind != FieldKind::kText) return value;
  const mcap::ByteView text = bytes(number<std::uint32_t>(value));
  return text.empty() ? text : text.first(text.size() - 1);
}

}  // namespace rtd::recording
