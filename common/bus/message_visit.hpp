// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <type_traits>

#include "common/bus/backend.hpp"

namespace rtd::bus {

template <class Result, class Visitor, class... T>
Result visit_message_type(MessageId id, Visitor& visitor, TypeList<T...>) {
  using Call = Result (*)(Visitor&);
  static constexpr Call kCalls[] = {[](Visitor& chosen) -> Result { return chosen.template operator()<T>(); }...};
  const auto place = static_cast<std::size_t>(id);
  if (place < sizeof...(T)) return kCalls[place](visitor);
  throw BusError("message id " + std::to_string(place) + " is not one of common/bus/message_types.hpp");
}

/// Calls visitor.operator()<T>() with the plain struct T that belongs to `id`: the way from a run-time id back to a
/// type.
template <class Visitor>
decltype(auto) visit_message_type(MessageId id, Visitor&& visitor) {
  using Result = decltype(visitor.template operator()<msg::RgbdFrame>());
  return visit_message_type<Result>(id, visitor, MessageTypes());
}

/// The name under which every vendor registers the type, e.g. "nav_msgs::msg::dds_::Odometry_".
inline std::string dds_type_name(MessageId id) {
  std::string name = visit_message_type(id, []<class T>() -> const char* { return msg::type_name(msg::TypeOf<T>()); });
  return name.replace(name.find('/'), 1, "::msg::dds_::") + '_';
}

}  // namespace rtd::bus
