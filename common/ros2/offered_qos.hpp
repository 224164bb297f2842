// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/bus/raw_bus.hpp"

namespace rtd::ros2 {

/// QoS of the writers of a topic as the channel metadata `offered_qos_profiles` of rosbag2: YAML with numbers for the
/// policies, as its versions up to 8 write and all read it.
std::string offered_qos_text(const std::vector<bus::RawQos>& offered);

/// Reads it back, with numbers or, as rosbag2 writes since version 9, words. What is missing or makes no sense keeps
/// its default; no YAML: empty.
std::vector<bus::RawQos> parse_offered_qos(const std::string& text);

}  // namespace rtd::ros2
