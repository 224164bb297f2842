// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

#include "common/msg/parameters.hpp"
#include "common/msg/ros_graph.hpp"
#include "tests/unit/bus/random_message.hpp"

/// Messages of ROS 2's own services and of its list of nodes, with random content that their types allow.
namespace rtd::bus::reflect {

inline void keep_bounds(auto&) {}
inline void keep_bounds(msg::ParameterValue& value) {
  for (std::uint8_t& flag : value.bool_array_value) flag &= 1U;
}
inline void keep_bounds(msg::ParameterDescriptor& descriptor) {
  descriptor.floating_point_range.resize(1);
  descriptor.integer_range.resize(1);
}

template <class T>
void keep_all_bounds(T& message) {
  if constexpr (msg::Message<T>) {
    keep_bounds(message);
    msg::for_each_field(message, [](const char*, auto& field) { keep_all_bounds(field); });
  } else if constexpr (IsVector<T>::value) {
    for (auto& element : message) keep_all_bounds(element);
  }
}

template <class T>
T random_ros_message(std::mt19937_64& random) {
  T message;
  randomize(message, random);
  keep_all_bounds(message);
  return message;
}

}  // namespace rtd::bus::reflect
