// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "common/bus/writer_id.hpp"

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

/// What a profile means, in DDS terms but without a vendor. All profiles are reliable and keep-last.
struct QosSettings {
  int depth = 0;                 ///< history depth of writers and readers
  bool transient_local = false;  ///< late readers get the last `depth` samples of living writers
  bool data_sharing = false;     ///< samples stay in the writer's shared memory; this host only, plain types only
  int liveliness_lease_ms = 0;   ///< automatic liveliness; 0 = infinite
  int deadline_ms = 0;           ///< a writer promises a sample at least this often; 0 = no promise
};

/// The one table of QoS profiles; every backend maps QosSettings to its vendor.
QosSettings qos_settings(QosProfile profile);

/// DDS name of a policy by its number (DDS 1.4, annex 2.3.3), e.g. "RELIABILITY". Vendors number their own beyond 22.
std::string policy_name(unsigned id);

/// What can happen to an endpoint. Callbacks run on a bus thread: be brief, do not call the bus.
struct StatusCallbacks {
  std::function<void(int peers)> on_matched;                           ///< current number of matched peers
  std::function<void(const std::string& policy)> on_incompatible_qos;  ///< a peer was refused, the policy by name
  std::function<void(int alive)> on_liveliness;                        ///< readers: current number of alive writers
  std::function<void()> on_deadline_missed;
  std::function<void(int total)> on_samples_lost;      ///< readers: samples lost so far
  std::function<void(int total)> on_samples_rejected;  ///< readers: samples so far that did not fit into the history
  std::function<void(const std::string& type)> on_type_mismatch;  ///< a peer uses the topic's name with another type
  std::function<void()> on_too_large;  ///< writers: a message was not written (common/msg/largest_sample.hpp)
  /// Readers: a writer is matched, or no longer. What it has sent before may still come.
  std::function<void(const WriterId& writer, bool matched)> on_writer;
  /// Readers: whether messages of the writer are wanted, asked for each before its content is copied or looked at.
  std::function<bool(const WriterId& writer)> accepts;
};

}  // namespace rtd::bus
