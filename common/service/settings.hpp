// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "common/msg/status.hpp"

/// Settings that may change while a service runs: the heartbeat carries their values, a command of the service sets
/// one. Foxglove clients and `ros2 param` have them as parameters.
namespace rtd::service {

struct Setting {
  enum class Form { kSwitch, kNumber, kChoice };
  const char *name, *service;
  const char* metric;   ///< of the heartbeat, which has the value; of a choice the prefix of its word
  const char* command;  ///< "slam/localize_only"
  Form form;
  const char* help;
  double least = 0, most = 0;                     ///< of a number
  std::vector<std::string> (*words)() = nullptr;  ///< of a choice
};

/// All of them.
std::span<const Setting> live_settings();

/// By the form: a truth value, a number, a text.
using SettingValue = std::variant<bool, double, std::string>;

/// The value that a heartbeat has; nothing when it has none.
std::optional<SettingValue> value_in(const msg::ServiceStatus& status, const Setting& setting);

/// What the command takes; nothing for a value of another form.
std::optional<std::string> argument_of(const Setting& setting, const SettingValue& value);

}  // namespace rtd::service
