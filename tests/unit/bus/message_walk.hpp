// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "common/bus/message_types.hpp"
#include "common/msg/commands.hpp"
#include "common/msg/imu.hpp"
#include "common/msg/plausible.hpp"
#include "common/msg/ros_graph.hpp"

/// A plausible message of each type with at least one element in each sequence, and its fields one by one.
namespace rtd::bus::walk {

template <class T, class... All>
constexpr bool contains(TypeList<All...>) {
  return (std::is_same_v<T, All> || ...);
}
template <class T>
inline constexpr bool kOnBus = contains<T>(MessageTypes());

template <class... A, class... B>
TypeList<A..., B...> joined(TypeList<A...>, TypeList<B...>);

/// Every type that comes from outside.
using AllTypes = decltype(joined(
    MessageTypes(), TypeList<msg::Imu, msg::TriggerRequest, msg::SetBoolRequest, msg::CommandRequest, msg::CommandReply,
                             msg::ParameterNames, msg::ParticipantEntitiesInfo<16>>()));

template <class T>
inline constexpr bool kSequence = false;
template <class T>
inline constexpr bool kSequence<std::vector<T>> = true;
template <class T>
inline constexpr bool kArray = false;
template <class T, std::size_t kSize>
inline constexpr bool kArray<std::array<T, kSize>> = true;

/// Makes the fields of a message go together.
void complete(auto&) {}
template <std::uint32_t kWidth, std::uint32_t kHeight>
void complete(msg::SizedFrame<kWidth, kHeight>& frame) {
  frame.width = 640;
  frame.height = 480;
  frame.intrinsics = {500, 500, 320, 240};
}
inline void complete(msg::FeatureFrame& frame) {
  frame.width = 640;
  frame.height = 480;
  frame.intrinsics = {500, 500, 320, 240};
  frame.count = frame.removed = 2;
}
inline void complete(msg::KeyframeFeatures& keyframe) {
  keyframe.width = 640;
  keyframe.height = 480;
  keyframe.intrinsics = {500, 500, 320, 240};
}
inline void complete(msg::Image& image) {
  image.width = 4;
  image.height = 2;
  image.step = 5;
  image.data.resize(10);
}
inline void complete(msg::PointCloud2& cloud) {
  cloud.width = 3;
  cloud.height = 2;
  cloud.point_step = 16;
  cloud.row_step = 50;
  cloud.data.resize(100);
  cloud.fields = {{"x", 0, 7, 1}, {"rgb", 12, 7, 1}};
}
inline void complete(msg::OccupancyGrid& grid) {
  grid.info.width = grid.info.height = 1;
}
inline void complete(msg::MapKeyframe& keyframe) {
  keyframe.points_m.resize(3);
}
inline void complete(msg::MapUpdate& update) {
  update.loop_edges.resize(2);
}

template <class T>
T number_within(const msg::FieldRule& rule) {
  constexpr double kWanted = 0.5;  // four of them make a unit quaternion
  if (rule.free || (std::is_floating_point_v<T> && rule.least <= kWanted && kWanted <= rule.most))
    return static_cast<T>(kWanted);
  return static_cast<T>(rule.least <= 1 && 1 <= rule.most ? 1 : rule.most);
}

template <class T>
void fill(T& value, const msg::FieldRule& rule = {}) {
  if constexpr (std::is_enum_v<T>) {
    value = last_value(msg::TypeOf<T>());
  } else if constexpr (std::is_arithmetic_v<T>) {
    value = number_within<T>(rule);
  } else if constexpr (requires { typename T::Number; }) {
    value = number_within<typename T::Number>(rule);
  } else if constexpr (std::is_same_v<T, std::string>) {
    value = "text";
  } else if constexpr (kSequence<T>) {
    value.resize(1);
    fill(value[0], rule);
  } else if constexpr (kArray<T>) {
    for (auto& element : value) fill(element, rule);
  } else {
    std::size_t place = 0;
    msg::for_each_field(value, [&](const char*, auto& field) { fill(field, msg::plausible::kRules<T>[place++]); });
    complete(value);
  }
}

template <class T>
std::unique_ptr<T> plausible_message() {
  auto message = std::make_unique<T>();
  fill(*message);
  return message;
}

/// Calls visit(leaf, rule, "package/Type.field") with each number, text and sequence; of arrays with the first and the
/// last element, of the features of a frame with those that count.
template <msg::Message T, class Visit>
void for_each_leaf(T& message, Visit& visit);

template <class T, class Visit>
void visit_field(T& field, const msg::FieldRule& rule, const std::string& name, Visit& visit) {
  if constexpr (msg::Message<T>) {
    for_each_leaf(field, visit);
  } else if constexpr (kArray<T>) {
    visit_field(field.front(), rule, name, visit);
    const bool all_count = !std::is_same_v<T, std::array<msg::Feature, msg::kMaxFeatures>>;
    visit_field(all_count ? field.back() : field[1], rule, name, visit);
  } else {
    visit(field, rule, name);
    if constexpr (kSequence<T>) visit_field(field.back(), rule, name, visit);
  }
}

template <msg::Message T, class Visit>
void for_each_leaf(T& message, Visit& visit) {
  std::size_t place = 0;
  msg::for_each_field(message, [&](const char* name, auto& field) {
    visit_field(field, msg::plausible::kRules<T>[place++], std::string(type_name(msg::TypeOf<T>())) + '.' + name,
                visit);
  });
}

template <class... T, class Visit>
void for_each_type(TypeList<T...>, const Visit& visit) {
  (visit.template operator()<T>(), ...);
}

}  // namespace rtd::bus::walk
