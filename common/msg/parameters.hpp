// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/msg/fields.hpp"

/// Requests and replies of the six services of rcl_interfaces by which `ros2 param` reads and sets the parameters of a
/// node.
namespace rtd::msg {

/// rcl_interfaces/msg/ParameterType: numbers on the wire. Lists of values have larger ones and are not in use here.
namespace parameter_type {
inline constexpr std::uint8_t kNotSet = 0, kBool = 1, kInteger = 2, kDouble = 3, kString = 4;
}

/// `type` says which of the other fields counts.
struct ParameterValue {
  std::uint8_t type = parameter_type::kNotSet;
  bool bool_value = false;
  std::int64_t integer_value = 0;
  double double_value = 0;
  std::string string_value;
  std::vector<std::uint8_t> byte_array_value;
  std::vector<std::uint8_t> bool_array_value;
  std::vector<std::int64_t> integer_array_value;
  std::vector<double> double_array_value;
  std::vector<std::string> string_array_value;
};
RTD_FIELDS(rcl_interfaces, ParameterValue, type, bool_value, integer_value, double_value, string_value,
           byte_array_value, bool_array_value, integer_array_value, double_array_value, string_array_value)

struct Parameter {
  std::string name;
  ParameterValue value;
};
RTD_FIELDS(rcl_interfaces, Parameter, name, value)

/// A step of 0: any value between.
struct FloatingPointRange {
  double from_value = 0, to_value = 0, step = 0;
};
RTD_FIELDS(rcl_interfaces, FloatingPointRange, from_value, to_value, step)

struct IntegerRange {
  std::int64_t from_value = 0, to_value = 0;
  std::uint64_t step = 0;
};
RTD_FIELDS(rcl_interfaces, IntegerRange, from_value, to_value, step)

struct ParameterDescriptor {
  std::string name;
  std::uint8_t type = parameter_type::kNotSet;
  std::string description, additional_constraints;
  bool read_only = false, dynamic_typing = false;
  std::vector<FloatingPointRange> floating_point_range;  ///< at most one
  std::vector<IntegerRange> integer_range;               ///< at most one
};
RTD_FIELDS(rcl_interfaces, ParameterDescriptor, name, type, description, additional_constraints, read_only,
           dynamic_typing, floating_point_range, integer_range)

struct SetParametersResult {
  bool successful = false;
  std::string reason;
};
RTD_FIELDS(rcl_interfaces, SetParametersResult, successful, reason)

struct ListParametersResult {
  std::vector<std::string> names, prefixes;
};
RTD_FIELDS(rcl_interfaces, ListParametersResult, names, prefixes)

/// A depth of 0: all.
struct ListParametersRequest {
  std::vector<std::string> prefixes;
  std::uint64_t depth = 0;
};
RTD_FIELDS_OF(ListParametersRequest, "rcl_interfaces/ListParameters_Request", prefixes, depth)
struct ListParametersReply {
  ListParametersResult result;
};
RTD_FIELDS_OF(ListParametersReply, "rcl_interfaces/ListParameters_Response", result)

/// The request of the three services that ask about parameters.
struct ParameterNames {
  std::vector<std::string> names;
};
RTD_FIELDS_OF(ParameterNames, "rcl_interfaces/GetParameters_Request", names)
struct GetParametersReply {
  std::vector<ParameterValue> values;
};
RTD_FIELDS_OF(GetParametersReply, "rcl_interfaces/GetParameters_Response", values)
struct GetParameterTypesReply {
  std::vector<std::uint8_t> types;
};
RTD_FIELDS_OF(GetParameterTypesReply, "rcl_interfaces/GetParameterTypes_Response", types)
struct DescribeParametersReply {
  std::vector<ParameterDescriptor> descriptors;
};
RTD_FIELDS_OF(DescribeParametersReply, "rcl_interfaces/DescribeParameters_Response", descriptors)

/// The request of both services that set parameters.
struct ParameterList {
  std::vector<Parameter> parameters;
};
RTD_FIELDS_OF(ParameterList, "rcl_interfaces/SetParameters_Request", parameters)
struct SetParametersReply {
  std::vector<SetParametersResult> results;
};
RTD_FIELDS_OF(SetParametersReply, "rcl_interfaces/SetParameters_Response", results)
struct SetParametersAtomicallyReply {
  SetParametersResult result;
};
RTD_FIELDS_OF(SetParametersAtomicallyReply, "rcl_interfaces/SetParametersAtomically_Response", result)

}  // namespace rtd::msg
