// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/settings.hpp"

#include <algorithm>
#include <variant>

#include "common/service/metric_names.hpp"
#include "common/service/peer_clocks.hpp"
#include "common/service/settings.hpp"

namespace rtd::viewer {
namespace {

foxglove::ParameterValue to_parameter(const service::SettingValue& value) {
  return std::visit([](const auto& held) { return foxglove::ParameterValue(held); }, value);
}

auto find(const std::vector<page::ServiceLine>& services, std::string_view name) {
  return std::ranges::find(services, name, [](const page::ServiceLine& line) { return line.status.service; });
}

std::optional<std::string> argument_for(const service::Setting& setting, const foxglove::ParameterValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return argument_of(setting, *flag);
  if (const auto* number = std::get_if<double>(&value)) return argument_of(setting, *number);
  if (const auto* text = std::get_if<std::string>(&value)) return argument_of(setting, *text);
  return std::nullopt;
}

}  // namespace

std::vector<foxglove::Parameter> settings_of(const std::string& robot, const std::vector<page::ServiceLine>& services) {
  std::vector<foxglove::Parameter> parameters;
  for (const service::Setting& setting : service::live_settings()) {
    const auto line = find(services, setting.service);
    if (line == services.end()) continue;
    if (const auto value = value_in(line->status, setting))
      parameters.push_back({(robot.empty() ? "" : robot + '.') + setting.name, to_parameter(*value)});
  }
  return parameters;
}

std::optional<SettingCall> call_for(const foxglove::Parameter& parameter) {
  for (const service::Setting& setting : service::live_settings()) {
    if (!parameter.name.ends_with(setting.name)) continue;
    std::string robot = parameter.name.substr(0, parameter.name.size() - std::string_view(setting.name).size());
    if (!robot.empty() && robot.back() != '.') continue;
    if (!robot.empty()) robot = '/' + robot.substr(0, robot.size() - 1);
    const auto argument = argument_for(setting, parameter.value);
    return argument ? std::optional(SettingCall{robot + '/' + setting.command, *argument}) : std::nullopt;
  }
  return std::nullopt;
}

std::optional<page::Playback> playback_of(const std::vector<page::ServiceLine>& services) {
  const auto ended = [](const page::ServiceLine& line) {
    return line.status.state >= msg::ServiceState::kFinished || page::state_text(line) == std::string_view("gone");
  };
  const auto replay = find(services, "replay"), camera = find(services, "camera");
  if (replay == services.end()) return std::nullopt;
  const auto metric = [&](const char* name) { return service::find_metric(replay->status, name); };
  const auto position = metric(service::metric::kReplayPositionS), length = metric(service::metric::kReplayLengthS);
  if (!position || !length) return std::nullopt;
  return page::Playback{
      .position_s = *position,
      .length_s = *length,
      .speed = metric(service::metric::kReplaySpeed).value_or(1),
      .paused = metric(service::metric::kReplayPaused).value_or(0) != 0,
      .ended = ended(*replay),
      .begin_s = metric(service::metric::kReplayBeginS).value_or(0),
      .at_s = metric(service::metric::kReplayAtS).value_or(1e-9 * static_cast<double>(replay->status.stamp_ns)),
      .replaced = ended(*replay) && camera != services.end() && !ended(*camera)};
}

}  // namespace rtd::viewer
