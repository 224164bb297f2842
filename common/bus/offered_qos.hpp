// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/bus/raw_bus.hpp"

namespace rtd::bus {

/// QoS of the writers of a topic as the channel metadata `offered_qos_profiles` of rosbag2: YAML with numbers for the
/// policies, as rosbag2 up to version 8 writes and every version reads it.
std::string offered_qos_text(const std::vector<RawQos>& offered);

/// Reads it back, with numbers or, as rosbag2 writes since version 9, words. Missing and invalid values keep their
/// defaults; a text that is not YAML gives an empty list.
std::vector<RawQos> parse_offered_qos(const std::string& text);

}  // namespace rtd::bus
