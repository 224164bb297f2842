// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace rtd::bus {

/// What a topic is for. Each backend maps a profile to its own QoS in one place (docs/topics.md lists them).
enum class QosProfile : std::uint8_t {
  kRawFrame,      ///< reliable, keep-last 4, volatile, data sharing with loans, this host only
  kNetworkFrame,  ///< reliable, keep-last 8, volatile
  kLatched,       ///< reliable, keep-last 1, transient-local (camera info, point cloud)
  kDetections,    ///< reliable, keep-last 8, volatile
  kFeatures,      ///< reliable, keep-last 8, volatile
  kKeyframes,     ///< reliable, keep-last 64, transient-local
  kPose,          ///< reliable, keep-last 10, volatile: the ROS 2 default
  kTracking,      ///< reliable, keep-last 64, volatile: every frame counts, the consumer writes the trajectory
  kHeartbeat,     ///< reliable, keep-last 8, volatile, automatic liveliness 1 s
};

/// What can happen to an endpoint. Callbacks run on a bus thread: be brief, do not call the bus.
struct StatusCallbacks {
  std::function<void(int peers)> on_matched;                           ///< current number of matched peers
  std::function<void(const std::string& policy)> on_incompatible_qos;  ///< a peer was refused, the policy by name
  std::function<void(int alive)> on_liveliness;                        ///< readers: current number of alive writers
  std::function<void()> on_deadline_missed;
  std::function<void(int total)> on_samples_lost;      ///< readers: samples lost so far
  std::function<void(int total)> on_samples_rejected;  ///< readers: samples so far that did not fit into the history
  std::function<void(const std::string& type)> on_type_mismatch;  ///< a peer uses the topic's name with another type
};

}  // namespace rtd::bus
