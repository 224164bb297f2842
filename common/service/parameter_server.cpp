// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/parameter_server.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <utility>

#include "common/bus/ros_graph.hpp"
#include "common/msg/plausible.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::service {
namespace {

namespace type = msg::parameter_type;
using Form = Setting::Form;

std::uint8_t type_of(Form form) {
  return form == Form::kSwitch ? type::kBool : form == Form::kNumber ? type::kDouble : type::kString;
}

msg::ParameterValue to_parameter(const Setting& setting, const SettingValue& value) {
  msg::ParameterValue parameter;
  parameter.type = type_of(setting.form);
  if (const auto* flag = std::get_if<bool>(&value)) parameter.bool_value = *flag;
  if (const auto* number = std::get_if<double>(&value)) parameter.double_value = *number;
  if (const auto* text = std::get_if<std::string>(&value)) parameter.string_value = *text;
  return parameter;
}

/// A whole number is a number, too: `ros2 param set` takes "2" for one. Nothing for a type that no setting has.
std::optional<SettingValue> to_setting(const msg::ParameterValue& value) {
  switch (value.type) {
    case type::kBool:
      return value.bool_value;
    case type::kInteger:
      return static_cast<double>(value.integer_value);
    case type::kDouble:
      return value.double_value;
    case type::kString:
      return value.string_value;
    default:
      return std::nullopt;
  }
}

const char* wanted(Form form) {
  return form == Form::kSwitch ? "true or false" : form == Form::kNumber ? "a number" : "a text";
}

/// Whether a name lies below a prefix, at most `depth` parts further down; 0: at any depth.
bool lies_below(const std::string& name, const std::string& prefix, std::uint64_t depth) {
  if (name == prefix) return true;
  const std::string begin = prefix.empty() ? "" : prefix + '.';
  if (!name.starts_with(begin)) return false;
  const auto further = std::count(name.begin() + static_cast<std::ptrdiff_t>(begin.size()), name.end(), '.');
  return depth == 0 || static_cast<std::uint64_t>(further) < depth;
}

/// Indices of the parameters that count: of each name the last.
std::vector<std::size_t> last_of_each(const std::vector<msg::Parameter>& parameters) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    std::erase_if(kept, [&](std::size_t earlier) { return parameters[earlier].name == parameters[i].name; });
    kept.push_back(i);
  }
  return kept;
}

msg::SetParametersResult too_many(std::size_t count) {
  return {false, fmt::format("{} parameters in one request, at most {} are allowed", count, kMaxParameters)};
}

/// A request that cannot be read gets an empty reply.
template <class Request, class Answer>
auto handler(Answer answer) {
  return [answer](std::span<const std::byte> cdr) {
    try {
      Request request;
      ros::WireReader<ros::Wire::kCdr>{{reinterpret_cast<const std::uint8_t*>(cdr.data()), cdr.size()}}(request);
      return ros::encode_cdr(answer(request));
    } catch (const ros::WireError&) {
      return ros::encode_cdr(decltype(answer(Request()))());
    }
  };
}

/// "rq/anna/rtd_slam/list_parametersRequest", ...
bus::CallTopics topics_of(const std::string& node, const char* name, const std::string& service_type) {
  const std::string dds = "rcl_interfaces::srv::dds_::" + service_type;
  return {"rq" + node + '/' + name + "Request", dds + "_Request_", "rr" + node + '/' + name + "Reply",
          dds + "_Response_"};
}

std::vector<bus::CommandServer::Service> services_of(const std::string& node, Parameters& own) {
  using msg::ParameterList;
  using msg::ParameterNames;
  const auto on = [&own](auto method) { return [&own, method](const auto& asked) { return (own.*method)(asked); }; };
  return {
      {topics_of(node, "list_parameters", "ListParameters"),
       handler<msg::ListParametersRequest>(on(&Parameters::list))},
      {topics_of(node, "get_parameters", "GetParameters"), handler<ParameterNames>(on(&Parameters::get))},
      {topics_of(node, "get_parameter_types", "GetParameterTypes"), handler<ParameterNames>(on(&Parameters::types))},
      {topics_of(node, "describe_parameters", "DescribeParameters"),
       handler<ParameterNames>(on(&Parameters::describe))},
      {topics_of(node, "set_parameters", "SetParameters"), handler<ParameterList>(on(&Parameters::set))},
      {topics_of(node, "set_parameters_atomically", "SetParametersAtomically"),
       handler<ParameterList>(on(&Parameters::set_all))},
  };
}

std::string full_name(const std::string& service, const std::string& robot) {
  const bus::NodeName node = bus::node_name("rtd-" + service, robot);
  return (node.space == "/" ? "" : node.space) + '/' + node.name;
}

}  // namespace

Parameters::Parameters(std::string service, Heartbeat& heartbeat, std::shared_ptr<bus::CommandRegistry> commands)
    : service_(std::move(service)), heartbeat_(heartbeat), commands_(std::move(commands)) {}

const Setting* Parameters::find(const std::string& name) const {
  const auto settings = live_settings();
  const auto found = std::ranges::find_if(
      settings, [&](const Setting& setting) { return service_ == setting.service && name == setting.name; });
  return found != settings.end() && value_of(*found) ? &*found : nullptr;
}

std::optional<SettingValue> Parameters::value_of(const Setting& setting) const {
  return value_in(heartbeat_.own_status(), setting);
}

msg::ListParametersReply Parameters::list(const msg::ListParametersRequest& asked) const {
  const std::vector<std::string> prefixes = asked.prefixes.empty() ? std::vector<std::string>{""} : asked.prefixes;
  msg::ListParametersReply reply;
  if (prefixes.size() > kMaxParameters) return reply;
  for (const Setting& setting : live_settings()) {
    const std::string name = setting.name;
    const auto holds = [&](const std::string& prefix) { return lies_below(name, prefix, asked.depth); };
    if (find(name) == nullptr || std::ranges::none_of(prefixes, holds)) continue;
    reply.result.names.push_back(name);
    const std::string section = name.substr(0, name.rfind('.'));
    if (std::ranges::count(reply.result.prefixes, section) == 0) reply.result.prefixes.push_back(section);
  }
  return reply;
}

msg::GetParametersReply Parameters::get(const msg::ParameterNames& asked) const {
  msg::GetParametersReply reply;
  if (asked.names.size() > kMaxParameters) return reply;
  for (const std::string& name : asked.names) {
    const Setting* const setting = find(name);
    const auto value = setting != nullptr ? value_of(*setting) : std::nullopt;
    reply.values.push_back(value ? to_parameter(*setting, *value) : msg::ParameterValue());
  }
  return reply;
}

msg::GetParameterTypesReply Parameters::types(const msg::ParameterNames& asked) const {
  msg::GetParameterTypesReply reply;
  if (asked.names.size() > kMaxParameters) return reply;
  for (const std::string& name : asked.names) {
    const Setting* const setting = find(name);
    reply.types.push_back(setting != nullptr ? type_of(setting->form) : type::kNotSet);
  }
  return reply;
}

msg::DescribeParametersReply Parameters::describe(const msg::ParameterNames& asked) const {
  msg::DescribeParametersReply reply;
  if (asked.names.size() > kMaxParameters) return reply;
  for (const std::string& name : asked.names) {
    msg::ParameterDescriptor& descriptor = reply.descriptors.emplace_back();
    descriptor.name = name;
    const Setting* const setting = find(name);
    if (setting == nullptr) continue;
    descriptor.type = type_of(setting->form);
    descriptor.description = setting->help;
    if (setting->words != nullptr)
      descriptor.additional_constraints = fmt::format("one of {}", fmt::join(setting->words(), ", "));
    if (setting->form == Form::kNumber) descriptor.floating_point_range.push_back({setting->least, setting->most, 0});
  }
  return reply;
}

msg::SetParametersReply Parameters::set(const msg::ParameterList& asked) {
  const std::size_t count = asked.parameters.size();
  if (count > kMaxParameters) return {{count, too_many(count)}};
  std::map<std::string_view, msg::SetParametersResult> results;
  for (const std::size_t i : last_of_each(asked.parameters))
    results[asked.parameters[i].name] = set_one(asked.parameters[i]);
  msg::SetParametersReply reply;
  for (const msg::Parameter& parameter : asked.parameters) reply.results.push_back(results[parameter.name]);
  return reply;
}

msg::SetParametersAtomicallyReply Parameters::set_all(const msg::ParameterList& asked) {
  const std::size_t count = asked.parameters.size();
  if (count > kMaxParameters) return {too_many(count)};
  std::vector<std::pair<const Setting*, SettingValue>> before;
  msg::SetParametersAtomicallyReply reply{{true, ""}};
  for (const std::size_t i : last_of_each(asked.parameters)) {
    const msg::Parameter& parameter = asked.parameters[i];
    const Setting* const setting = find(parameter.name);
    const auto value = setting != nullptr ? value_of(*setting) : std::nullopt;
    reply.result = set_one(parameter);
    if (!reply.result.successful) break;
    if (value) before.emplace_back(setting, *value);
  }
  if (!reply.result.successful)
    for (auto old = before.rbegin(); old != before.rend(); ++old) apply(*old->first, old->second);
  return reply;
}

msg::SetParametersResult Parameters::set_one(const msg::Parameter& parameter) {
  if (const msg::ImplausibleField bad = msg::implausible_field(parameter))
    return {false, to_string(bad) + " is not allowed: texts have one line, numbers are finite"};
  const Setting* const setting = find(parameter.name);
  if (setting == nullptr) {
    const msg::ListParametersReply all = list({});
    return {false, fmt::format("rtd_{} has no such parameter{}{}", service_,
                               all.result.names.empty() ? "" : "; it has ", fmt::join(all.result.names, ", "))};
  }
  const std::optional<SettingValue> value = to_setting(parameter.value);
  if (!value) return {false, fmt::format("{} takes {}", setting->name, wanted(setting->form))};
  return apply(*setting, *value);
}

/// The heartbeat says it at once: a reader that asks next gets the new value.
msg::SetParametersResult Parameters::apply(const Setting& setting, const SettingValue& value) {
  const std::optional<std::string> argument = argument_of(setting, value);
  if (!argument) return {false, fmt::format("{} takes {}", setting.name, wanted(setting.form))};
  if (value_of(setting) == value) return {true, ""};
  const auto answer = commands_->call(setting.command, {*argument});
  if (!answer) return {false, fmt::format("rtd_{} does not take /{} now", service_, setting.command)};
  if (!answer->success) return {false, answer->message};
  if (const auto* flag = std::get_if<bool>(&value)) heartbeat_.set_metric(setting.metric, *flag ? 1 : 0);
  if (const auto* number = std::get_if<double>(&value)) heartbeat_.set_metric(setting.metric, *number);
  if (const auto* text = std::get_if<std::string>(&value)) heartbeat_.set_word(setting.metric, *text);
  return {true, answer->message};
}

ParameterServer::ParameterServer(bus::Bus& bus, const std::string& service, Heartbeat& heartbeat)
    : parameters_(service, heartbeat, bus.commands()), server_(bus) {
  server_.offer_services(services_of(full_name(service, bus.robot()), parameters_));
}

}  // namespace rtd::service
