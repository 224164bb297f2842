// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace rtd::test_support {

/// What a user of ROS 2 may have set, or what the RMW makes of it.
///   unset, localhost_only=0    Humble: the vendor's defaults
///   localhost_only=1           Humble
///   SUBNET, LOCALHOST, OFF, SYSTEM_DEFAULT    ROS_AUTOMATIC_DISCOVERY_RANGE, Iron and later; SUBNET is their default
inline constexpr const char* kRosSettings[] = {
    "unset", "localhost_only=0", "localhost_only=1", "SUBNET", "LOCALHOST", "SYSTEM_DEFAULT", "OFF"};

/// A participant that is set up as an RMW sets up its own, directly on the vendor's library: it reads `rt/slam/pose`
/// and writes `rt/camera/ground_truth`.
class RmwDouble {
 public:
  virtual ~RmwDouble() = default;
  virtual void write() = 0;
  /// Messages that have come since the last call.
  virtual int take() = 0;
};

/// As rmw_fastrtps does. Throws std::runtime_error.
std::unique_ptr<RmwDouble> double_of_fastrtps(const std::string& setting, std::uint32_t domain);
/// As rmw_cyclonedds does. Throws std::runtime_error.
std::unique_ptr<RmwDouble> double_of_cyclonedds(const std::string& setting, std::uint32_t domain);

}  // namespace rtd::test_support
