// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/msg/fields.hpp"

/// Requests and replies of the ROS 2 services that RTD-SLAM offers and calls (common/bus/commands.hpp).
namespace rtd::msg {

/// ROS gives an empty message one byte.
struct TriggerRequest {
  std::uint8_t structure_needs_at_least_one_member = 0;
};
RTD_FIELDS_OF(TriggerRequest, "std_srvs/Trigger_Request", structure_needs_at_least_one_member)

struct SetBoolRequest {
  bool data = false;
};
RTD_FIELDS_OF(SetBoolRequest, "std_srvs/SetBool_Request", data)

struct CommandRequest {
  std::string argument;
};
RTD_FIELDS_OF(CommandRequest, "rtd_msgs/Command_Request", argument)

/// The same for all three services.
struct CommandReply {
  bool success = false;
  std::string message;
};
RTD_FIELDS_OF(CommandReply, "rtd_msgs/Command_Response", success, message)

}  // namespace rtd::msg
