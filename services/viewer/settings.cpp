// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/service/metric_names.hpp"
#include "common/service/peer_clocks.hpp"

namespace rtd::viewer {
namespace {

/// A setting: the metric that has its value, of a choice the prefix of its word, and the command that changes it.
struct Setting {
  const char *name, *service, *metric, *command;
  enum class Form { kSwitch, kNumber, kChoice } form;
};
constexpr std::array kSettings = {
    Setting{"slam.localize_only", "slam", service::metric::kLocalizeOnly, "/slam/localize_only",
            Setting::Form::kSwitch},
    Setting{"filter.mode", "filter", service::metric::kModePrefix, "/filter/set_mode", Setting::Form::kChoice},
    Setting{"replay.paused", "replay", service::metric::kReplayPaused, "/replay/pause", Setting::Form::kSwitch},
    Setting{"replay.speed", "replay", service::metric::kReplaySpeed, "/replay/speed", Setting::Form::kNumber},
};

/// Empty: the heartbeat does not say.
std::optional<foxglove::ParameterValue> value_of(const Setting& setting, const msg::ServiceStatus& status) {
  if (setting.form == Setting::Form::kChoice) {
    const std::string word = msg::word_of(status, setting.metric);
    return word.empty() ? std::nullopt : std::optional<foxglove::ParameterValue>(word);
  }
  const std::optional<double> metric = service::find_metric(status, setting.metric);
  if (!metric) return std::nullopt;
  return setting.form == Setting::Form::kSwitch ? foxglove::ParameterValue(*metric != 0) : *metric;
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
  for (const Setting& setting : kSettings) {
    const auto status = std::ranges::find(services, setting.service, &msg::ServiceStatus::service);
    if (status == services.end()) continue;
    if (const auto value = value_of(setting, *status))
      parameters.push_back({(robot.empty() ? "" : robot + '.') + setting.name, *value});
  }
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
