// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/writer_id.hpp"

#include <span>

namespace rtd::bus {
namespace {

std::string hexadecimal(std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

}  // namespace

std::string to_string(const WriterId& id) {
  return hexadecimal(id);
}

std::string to_string(const ParticipantId& id) {
  return hexadecimal(id);
}

}  // namespace rtd::bus
