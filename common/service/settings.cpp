// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/settings.hpp"

#include <fmt/format.h>

#include <array>

#include "common/msg/filter_modes.hpp"
#include "common/msg/replay_rates.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/peer_clocks.hpp"

namespace rtd::service {
namespace {

using Form = Setting::Form;

const std::array kSettings = {
    Setting{"slam.localize_only", "slam", metric::kLocalizeOnly, "slam/localize_only", Form::kSwitch,
            "finds the camera in the map and leaves the map as it is"},
    Setting{"filter.mode", "filter", metric::kModePrefix, "filter/set_mode", Form::kChoice,
            "which parts of the filter judge points", 0, 0, msg::filter_mode_names},
    Setting{"replay.paused", "replay", metric::kReplayPaused, "replay/pause", Form::kSwitch, "the replay stands still"},
    Setting{"replay.speed", "replay", metric::kReplaySpeed, "replay/speed", Form::kNumber,
            "how fast the replay plays, 1 = as recorded", msg::kLowestReplayRate, msg::kHighestReplayRate},
};

}  // namespace

std::span<const Setting> live_settings() {
  return kSettings;
}

std::optional<SettingValue> value_in(const msg::ServiceStatus& status, const Setting& setting) {
  if (setting.form == Form::kChoice) {
    const std::string word = msg::word_of(status, setting.metric);
    return word.empty() ? std::nullopt : std::optional<SettingValue>(word);
  }
  const std::optional<double> metric = find_metric(status, setting.metric);
  if (!metric) return std::nullopt;
  return setting.form == Form::kSwitch ? SettingValue(*metric != 0) : SettingValue(*metric);
}

std::optional<std::string> argument_of(const Setting& setting, const SettingValue& value) {
  if (const auto* flag = std::get_if<bool>(&value); flag != nullptr && setting.form == Form::kSwitch)
    return *flag ? "true" : "false";
  if (const auto* number = std::get_if<double>(&value); number != nullptr && setting.form == Form::kNumber)
    return fmt::format("{}", *number);
  if (const auto* text = std::get_if<std::string>(&value); text != nullptr && setting.form == Form::kChoice)
    return *text;
  return std::nullopt;
}

}  // namespace rtd::service
