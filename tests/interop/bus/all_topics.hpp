// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "common/bus/qos.hpp"
#include "common/bus/topics.hpp"
#include "common/ros_codec/wire.hpp"
#include "tests/unit/bus/random_message.hpp"

/// Messages for every topic that two processes can both make: from the topic's name and a number.
namespace rtd::bus::interop {

template <class Visitor>
void for_each_topic(Visitor visit) {
  using namespace topics;
  visit(kFrame), visit(kFrame848), visit(kFrame1280), visit(kFrame1920), visit(kFeatures), visit(kKeyframes),
      visit(kTracking), visit(kStatus), visit(kColorJpeg);
  visit(kCameraInfo), visit(kDetections), visit(kDynamicMask), visit(kOdometry), visit(kPose), visit(kTf);
  visit(kPath), visit(kMapPoints), visit(kDensePoints), visit(kDiagnostics);
  visit(kMap), visit(kMovers), visit(kMoverBoxes), visit(kMoverMarkers), visit(kGroundTruth);
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

template <class T>
void make_plausible(T&) {}
template <std::uint32_t kWidth, std::uint32_t kHeight>
void make_plausible(msg::SizedFrame<kWidth, kHeight>& frame) {
  frame.width = kWidth;
  frame.height = kHeight;
}
inline void make_plausible(msg::FeatureFrame& features) {
  features.count = msg::kMaxFeatures;
}

/// The message of that number on the topic: every byte of it is random, but the same in all processes.
template <class T>
std::unique_ptr<T> message_of(const Topic<T>& topic, int number) {
  std::seed_seq seed{std::hash<std::string>{}(topic.name), static_cast<std::size_t>(number)};
  std::mt19937_64 random(seed);
  auto message = std::make_unique<T>();
  if constexpr (MessageTraits<T>::kPlain) {
    static_assert(sizeof(T) % sizeof(std::uint64_t) == 0);
    for (std::size_t at = 0; at < sizeof(T); at += sizeof(std::uint64_t)) {
      const std::uint64_t bytes = random();
      std::memcpy(reinterpret_cast<unsigned char*>(message.get()) + at, &bytes, sizeof(bytes));
    }
    make_plausible(*message);
  } else {
    reflect::randomize(*message, random);
  }
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
