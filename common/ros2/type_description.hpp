// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/ros_codec/message_definition.hpp"

/// Message types in the words of ROS 2: fields, definitions, hashes. By DDS name ("nav_msgs::msg::dds_::Odometry_")
/// unless said otherwise.
namespace rtd::ros2 {

using ros::MessageField;
using ros::MessageFields;

/// Every type that the bus carries, and all that they are made of: the lists of common/msg.
const MessageFields& message_fields();

/// The fields of "package/Type"; null when the type is unknown.
const std::vector<MessageField>* fields_of(const std::string& type);

/// A type as the schema of a recording has it.
struct TypeDefinition {
  std::string name;  ///< "nav_msgs/msg/Odometry"; a type of our own: "rtd_msgs::msg::dds_::RgbdFrame_", as in its text
  std::string encoding;  ///< "ros2msg", "omgidl", or empty for an unknown type
  std::string text;      ///< complete, with all types that it is made of
  bool known() const { return !encoding.empty(); }
};

TypeDefinition definition_of(const std::string& dds_type);

/// The text of "package/Type" in the encoding "ros2msg" by its fields and those of all that it is made of.
std::string ros2msg_text(const std::string& type, const MessageFields& types);

/// The file Type.msg of a type of our own ("rtd_msgs/Type") in idl/ros2/rtd_msgs/msg: its fields below what
/// idl/rtd_msgs.idl says about it.
std::string msg_file(const std::string& type);

/// The text of idl/rtd_msgs.idl.
const std::string& own_idl();

/// The hash by which ROS 2, from Iron on, checks that two programs mean the same type by one name: SHA-256 of
/// its description as JSON (REP-2011, REP-2016). Writers and readers announce it in the USER_DATA of their discovery.
/// "RIHS01_<64 hexadecimal digits>"; empty for an unknown type. Requests and replies have that of their service, as
/// both RMWs announce it.
std::string type_hash(const std::string& dds_type);

/// The same for "package/Type" from its fields and those of all that it is made of. Throws std::out_of_range when one
/// is missing.
std::string type_hash(const std::string& type, const MessageFields& types);

/// The USER_DATA of an endpoint of that type: "typehash=RIHS01_...;". Never empty: ROS 2 warns of an endpoint without.
std::string user_data_of(const std::string& dds_type);

/// The hash in the USER_DATA of an endpoint, or empty.
std::string hash_in(const std::string& user_data);

/// The fields of `struct_name` ("RgbdFrame_") in a text of the OMG's IDL, and those of the types that it is made of,
/// without comments and white space: two texts give the same when samples have the same bytes. Empty when the text does
/// not define it.
std::string layout_in(const std::string& idl, const std::string& struct_name);

}  // namespace rtd::ros2
