// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

/// Protobuf's wire format, without its library. Nothing here reads outside the bytes, whatever they hold.
namespace rtd::detector::protobuf {

using Span = std::span<const std::uint8_t>;

struct Field {
  int number = 0;
  std::uint64_t varint = 0;  ///< of a field that is a number
  Span bytes;                ///< of all others; no data() for a number
};

/// Takes the first bytes off a span; empty when it has less.
std::optional<Span> take_bytes(Span& span, std::uint64_t count);
std::optional<std::uint64_t> take_varint(Span& span);
/// The next field of a message; empty at its end or where it is malformed.
std::optional<Field> take_field(Span& span);
/// The first field of this number that is no number itself.
std::optional<Span> find_message(Span span, int number);
std::string text_of(const std::optional<Span>& span);

}  // namespace rtd::detector::protobuf
