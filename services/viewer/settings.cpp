// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

namespace rtd::viewer {
namespace {

/// A setting: the metric that has its value and the command that changes it.
struct Setting {
  const char *name, *service, *metric, *command;
  enum class Form { kSwitch, kNumber, kChoice } form;
};
constexpr std::array kSettings = {
    Setting{"slam.localize_only", "slam", "localize_only", "/slam/localize_only", Setting::Form::kSwitch},
    Setting{"filter.mode", "filter", "mode", "/filter/set_mode", Setting::Form::kChoice},
    Setting{"replay.paused", "replay", "replay.paused", "/replay/pause", Setting::Form::kSwitch},
    Setting{"replay.speed", "replay", "replay.speed", "/replay/speed", Setting::Form::kNumber},
};
/// In the order of filter::FilterMode.
constexpr const char* kFilterModes[] = {"off", "semantic", "geometry", "epipolar", "rtd-paper", "rtd"};

std::optional<double> metric_of(const std::vector<msg::ServiceStatus>& services, const std::string& service,
                                const std::string& name) {
  const auto status = std::ranges::find(services, service, &msg::ServiceStatus::service);
  if (status == services.end()) return std::nullopt;
  const auto metric = std::ranges::find(status->metrics, name, &msg::Metric::name);
  return metric == status->metrics.end() ? std::nullopt : std::optional(metric->value);
}

foxglove::ParameterValue value_of(Setting::Form form, double metric) {
  if (form == Setting::Form::kSwitch) return metric != 0;
  if (form == Setting::Form::kNumber) return metric;
  const bool known = metric >= 0 && metric < static_cast<double>(std::size(kFilterModes));
  return known ? foxglove::ParameterValue(std::string(kFilterModes[static_cast<std::size_t>(metric)]))
               : std::monostate();
}

std::optional<std::string> argument_of(Setting::Form form, const foxglove::ParameterValue& value) {
  if (const auto* flag = std::get_if<bool>(&value); flag != nullptr && form == Setting::Form::kSwitch)
    return *flag ? "true" : "false";
  if (const auto* number = std::get_if<double>(&value); number != nullptr && form == Setting::Form::kNumber)
    return fmt::format("{}", *number);
  if (const auto* text = std::get_if<std::string>(&value); text != nullptr && form == Setting::Form::kChoice)
    return *text;
  return std::nullopt;
}

}  // namespace

std::vector<foxglove::Parameter> settings_of(const std::string& robot,
                                             const std::vector<msg::ServiceStatus>& services) {
  std::vector<foxglove::Parameter> parameters;
  for (const Setting& setting : kSettings)
    if (const auto metric = metric_of(services, setting.service, setting.metric))
      parameters.push_back({(robot.empty() ? "" : robot + '.') + setting.name, value_of(setting.form, *metric)});
  return parameters;
}

std::optional<SettingCall> call_for(const foxglove::Parameter& parameter) {
  for (const Setting& setting : kSettings) {
    if (!parameter.name.ends_with(setting.name)) continue;
    std::string robot = parameter.name.substr(0, parameter.name.size() - std::string_view(setting.name).size());
    if (!robot.empty() && robot.back() != '.') continue;
    if (!robot.empty()) robot = '/' + robot.substr(0, robot.size() - 1);
    const auto argument = argument_of(setting.form, parameter.value);
    return argument ? std::optional(SettingCall{robot + setting.command, *argument}) : std::nullopt;
  }
  return std::nullopt;
}

std::optional<page::Playback> playback_of(const std::vector<page::ServiceLine>& services) {
  const auto service = [&](const char* name) {
    return std::ranges::find(services, name, [](const page::ServiceLine& line) { return line.status.service; });
  };
  const auto ended = [](const page::ServiceLine& line) {
    return line.status.state >= msg::ServiceState::kFinished || page::state_text(line) == std::string_view("gone");
  };
  const auto replay = service("replay"), camera = service("camera");
  if (replay == services.end()) return std::nullopt;
  const auto metric = [&](const char* name) { return metric_of({replay->status}, "replay", name); };
  const auto position = metric("replay.position_s"), length = metric("replay.length_s");
  if (!position || !length) return std::nullopt;
  return page::Playback{.position_s = *position,
                        .length_s = *length,
                        .speed = metric("replay.speed").value_or(1),
                        .paused = metric("replay.paused").value_or(0) != 0,
                        .ended = ended(*replay),
                        .begin_s = metric("replay.begin_s").value_or(0),
                        .at_s = metric("replay.at_s").value_or(1e-9 * static_cast<double>(replay->status.stamp_ns)),
                        .replaced = ended(*replay) && camera != services.end() && !ended(*camera)};
}

}  // namespace rtd::viewer
