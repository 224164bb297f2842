// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/ros_codec/byte_cursor.hpp"
#include "common/ros_codec/message_definition.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::ros2 {

/// Whether messages of this type can be read by field: "nav_msgs::msg::dds_::Odometry_".
bool can_read(const std::string& dds_type);

/// Reads a message from its CDR bytes with their header (XCDR1, little endian); each field goes by its name. Keeps at
/// most `most_values` numbers or texts of an array, or a quarter as many messages (0: all); a shortened array becomes
/// {"count": N, "first": [..]}. NaN and infinity become texts. Throws ros::WireError if the bytes do not hold such a
/// message or the type is unknown.
nlohmann::ordered_json message_json(const std::string& dds_type, ros::Bytes cdr, std::size_t most_values);

/// The same by the fields of other types: `type` ("package/Type") and all that it is made of are in `types`. A time or
/// duration of ROS 1 becomes {"sec", "nanosec"}. Where `types` has a std_msgs/Header without the counter that ROS 1
/// sends, the counter is skipped. Time and memory are bounded by the bytes, whatever the types claim. Throws
/// ros::WireError.
nlohmann::ordered_json message_json(const ros::MessageFields& types, const std::string& type, ros::Wire wire,
                                    ros::Bytes bytes, std::size_t most_values);

}  // namespace rtd::ros2
