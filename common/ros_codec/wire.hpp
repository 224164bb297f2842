// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

#include "common/msg/ros.hpp"

namespace rtd::ros {

/// How a message is written down.
enum class Wire {
  kRos1,  ///< ROS 1: packed, a header begins with a counter, strings without end mark
  kCdr    ///< ROS 2: XCDR1 little endian behind a 4-byte header; numbers aligned, strings end with NUL
};

/// Calls step(part) with each part of a message in the order of the wire.
template <Wire kFormat, class Message>
void for_each_part(Message& message, auto&& step) {
  if constexpr (kFormat == Wire::kRos1 && std::same_as<std::remove_const_t<Message>, msg::Header>) {
    std::uint32_t seq = 0;  // counts the publisher's messages; not used here
    step(seq);
  }
  msg::for_each_field(message, [&](const char*, auto& field) { step(field); });
}

/// A number at any address: msg::Unaligned.
template <class T>
concept UnalignedNumber = requires {
  typename T::Number;
};

}  // namespace rtd::ros
