// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/ros2/message_fields.hpp"

/// The hash by which ROS 2, from Iron on, checks that two programs mean the same type by one name: SHA-256 of
/// its description as JSON (REP-2011, REP-2016). Writers and readers announce it in the USER_DATA of their discovery.
namespace rtd::ros2 {

/// "RIHS01_<64 hexadecimal digits>"; empty for a type that is unknown or our own. By DDS name:
/// "nav_msgs::msg::dds_::Odometry_".
std::string type_hash(const std::string& dds_type);

/// The same for "package/Type" from its fields and those of all that it is made of. Throws std::out_of_range when one
/// is missing.
std::string type_hash(const std::string& type, const MessageFields& types);

/// The USER_DATA of an endpoint of that type: "typehash=RIHS01_...;", or empty.
std::string user_data_of(const std::string& dds_type);

/// The hash in the USER_DATA of an endpoint, or empty.
std::string hash_in(const std::string& user_data);

}  // namespace rtd::ros2
