// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/msg/status.hpp"
#include "services/viewer/core/foxglove.hpp"
#include "services/viewer/core/page_messages.hpp"

/// Settings that may change while a run continues, as parameters of Foxglove clients: their values come from
/// heartbeats, setting one calls a command.
namespace rtd::viewer {

/// Those that the services of a robot report; names begin with the robot's, if it has one: "anna.filter.mode".
std::vector<foxglove::Parameter> settings_of(const std::string& robot, const std::vector<page::ServiceLine>& services);

/// A call that sets a parameter.
struct SettingCall {
  std::string command, argument;
};
/// Empty: there is no such parameter, or not of this kind of value.
std::optional<SettingCall> call_for(const foxglove::Parameter& parameter);

/// What a replay among the services says about itself; empty without one.
std::optional<page::Playback> playback_of(const std::vector<page::ServiceLine>& services);

}  // namespace rtd::viewer
