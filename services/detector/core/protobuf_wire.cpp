// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/protobuf_wire.hpp"

namespace rtd::detector::protobuf {
namespace {

enum WireType : int { kVarint = 0, kFixed64 = 1, kLengthDelimited = 2, kFixed32 = 5 };

}  // namespace

std::optional<Span> take_bytes(Span& span, std::uint64_t count) {
  if (count > span.size()) return std::nullopt;
  const Span taken = span.first(count);
  span = span.subspan(count);
  return taken;
}

std::optional<std::uint64_t> take_varint(Span& span) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64 && !span.empty(); shift += 7) {
    const std::uint8_t byte = take_bytes(span, 1)->front();
    value |= std::uint64_t{byte & 0x7FU} << shift;
    if ((byte & 0x80U) == 0) return value;
  }
  return std::nullopt;
}

std::optional<Field> take_field(Span& span) {
  const std::optional<std::uint64_t> key = take_varint(span);
  if (!key) return std::nullopt;
  Field field{static_cast<int>(*key >> 3U & 0x1FFFFFFFU), 0, {}};
  const int wire_type = static_cast<int>(*key & 7U);
  std::optional<std::uint64_t> number;  // the value of a varint, the length of other fields
  if (wire_type == kVarint || wire_type == kLengthDelimited) number = take_varint(span);
  if (wire_type == kFixed64) number = 8;
  if (wire_type == kFixed32) number = 4;
  if (!number) return std::nullopt;
  if (wire_type == kVarint) {
    field.varint = *number;
    return field;
  }
  const std::optional<Span> body = take_bytes(span, *number);
  if (!body) return std::nullopt;
  field.bytes = *body;
  return field;
}

std::optional<Span> find_message(Span span, int number) {
  while (const std::optional<Field> field = take_field(span)) {
    if (field->number == number && field->bytes.data() != nullptr) return field->bytes;
  }
  return std::nullopt;
}

std::string text_of(const std::optional<Span>& span) {
  return span ? std::string(span->begin(), span->end()) : std::string();
}

}  // namespace rtd::detector::protobuf
