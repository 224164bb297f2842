// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/ros_codec/byte_cursor.hpp"

namespace rtd::ros2 {

/// Whether messages of this type can be read by field: "nav_msgs::msg::dds_::Odometry_".
bool can_read(const std::string& dds_type);

/// A message by the names of its fields, from its CDR bytes with their header (XCDR1, little endian). Of an array at
/// most `most_values` numbers or texts, or a quarter as many messages, are kept, 0: all; a cut one becomes {"count": N,
/// "first": [..]}. NaN and infinity become texts. Throws ros::WireError for bytes that do not hold such a message, and
/// for a type that is not known.
nlohmann::ordered_json message_json(const std::string& dds_type, ros::Bytes cdr, std::size_t most_values);

}  // namespace rtd::ros2
