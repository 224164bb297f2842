// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

#include "common/msg/message_list.hpp"

namespace rtd::bus {

using msg::MessageTypes;
using msg::TypeList;

/// The place of a type in the list.
enum class MessageId : std::uint8_t {};

template <class T, class... All>
consteval MessageId place_in(TypeList<All...>) {
  static_assert((std::same_as<T, All> || ...), "not one of MessageTypes");
  std::uint8_t place = 0;
  (void)((std::same_as<T, All> || (++place, false)) || ...);
  return MessageId{place};
}

template <class T>
struct MessageTraits {
  static constexpr MessageId kId = place_in<T>(MessageTypes());
  /// Of fixed size, the same bytes in memory as on the wire, so it can be loaned.
  static constexpr bool kPlain = std::is_trivially_copyable_v<T>;
};

}  // namespace rtd::bus
