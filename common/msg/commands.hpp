// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/msg/fields.hpp"
#include "common/msg/parameters.hpp"

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

/// Calls visit.operator()<Request, Reply>("package/srv/Type") for each type of service.
void for_each_service(auto&& visit) {
  visit.template operator()<TriggerRequest, CommandReply>("std_srvs/srv/Trigger");
  visit.template operator()<SetBoolRequest, CommandReply>("std_srvs/srv/SetBool");
  visit.template operator()<CommandRequest, CommandReply>("rtd_msgs/srv/Command");
  visit.template operator()<ListParametersRequest, ListParametersReply>("rcl_interfaces/srv/ListParameters");
  visit.template operator()<ParameterNames, GetParametersReply>("rcl_interfaces/srv/GetParameters");
  visit.template operator()<ParameterNames, GetParameterTypesReply>("rcl_interfaces/srv/GetParameterTypes");
  visit.template operator()<ParameterNames, DescribeParametersReply>("rcl_interfaces/srv/DescribeParameters");
  visit.template operator()<ParameterList, SetParametersReply>("rcl_interfaces/srv/SetParameters");
  visit.template operator()<ParameterList, SetParametersAtomicallyReply>("rcl_interfaces/srv/SetParametersAtomically");
}

}  // namespace rtd::msg
