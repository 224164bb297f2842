// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "common/bus/qos.hpp"
#include "common/bus/topics.hpp"
#include "common/ros_codec/wire.hpp"
#include "tests/unit/bus/message_walk.hpp"

/// Messages for every topic that two processes can both make: from the topic's name and a number.
namespace rtd::bus::interop {

template <class Visitor>
void for_each_topic(Visitor visit) {
  using namespace topics;
  visit(kFrame);
  visit(kFrame848);
  visit(kFrame1280);
  visit(kFrame1920);
  visit(kFeatures);
  visit(kKeyframes);
  visit(kTracking);
  visit(kStatus);
  visit(kColorJpeg);
  visit(kDepthJpeg);
  visit(kCameraInfo);
  visit(kDetections);
  visit(kPersonMasks);
  visit(kDynamicMask);
  visit(kOdometry);
  visit(kPose);
  visit(kTf);
  visit(kTfStatic);
  visit(kMapJumps);
  visit(kPath);
  visit(kMapPoints);
  visit(kDensePoints);
  visit(kMovingPoints);
  visit(kDiagnostics);
  visit(kMap);
  visit(kKeyframeFeatures);
  visit(kKeyframeRequest);
  visit(kSubmap);
  visit(kAtlas);
  visit(kAtlasRobots);
  visit(kAtlasPoints);
  visit(kAtlasFloorPlan);
  visit(kAtlasMapJumps);
  visit(kMovers);
  visit(kMoverBoxes);
  visit(kMoverMarkers);
  visit(kGroundTruth);
  visit(kOccupancyGrid);
}

/// Messages of one round: as many as the topic's history holds, three at most; one raw frame, as a camera writes them.
/// Of several that Cyclone DDS writes in one go, Fast DDS may lose one on a busy computer (docs/topics.md).
inline int burst(QosProfile profile) {
  return profile == QosProfile::kRawFrame ? 1 : std::min(3, qos_settings(profile).depth);
}
/// Messages that a late reader of a transient-local topic is to get, and how many were written before them.
inline int kept(QosProfile profile) {
  return qos_settings(profile).depth;
}
constexpr int kForgotten = 5;

/// Gives the fields that may hold anything random values, also each pixel.
template <class T>
void scatter(T& value, const msg::FieldRule& rule, std::mt19937_64& random) {
  if constexpr (std::is_same_v<T, std::string>) {
    for (char& letter : value) letter = static_cast<char>('a' + random() % 26);
  } else if constexpr (walk::kSequence<T> || walk::kArray<T>) {
    for (auto& element : value) scatter(element, rule, random);
  } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    if (rule.free) value = static_cast<T>(random());
  } else if constexpr (msg::Message<T>) {
    std::size_t place = 0;
    msg::for_each_field(value,
                        [&](const char*, auto& field) { scatter(field, msg::plausible::kRules<T>[place++], random); });
    walk::complete(value);
  }
}

/// The message of that number on the topic: random, but the same in all processes, and one that the bus lets pass.
template <class T>
std::unique_ptr<T> message_of(const Topic<T>& topic, int number) {
  std::seed_seq seed{std::hash<std::string>{}(topic.name), static_cast<std::size_t>(number)};
  std::mt19937_64 random(seed);
  auto message = walk::plausible_message<T>();
  scatter(*message, {}, random);
  return message;
}

/// All that the message holds, as bytes.
template <class T>
std::vector<std::uint8_t> bytes_of(const T& message) {
  if constexpr (MessageTraits<T>::kPlain) {
    const auto* const first = reinterpret_cast<const std::uint8_t*>(&message);
    return {first, first + sizeof(T)};
  } else {
    return ros::encode<ros::Wire::kCdr>(message);
  }
}

}  // namespace rtd::bus::interop
