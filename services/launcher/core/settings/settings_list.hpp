// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace rtd::launcher {

/// A setting as a service prints it: "slam.base.camera", "\"\"", "where the camera is ... (--camera-in-base)".
struct PrintedSetting {
  std::string key, value, help;
};

/// All settings of what a service prints with --print-config.
std::vector<PrintedSetting> parse_printed(const std::string& text);

/// The settings that people change, about twenty, with the values in force, and how to change them: for `rtd config`.
/// `print_config` gives what the service of a name prints; empty: it is not installed, and its settings are left out.
std::string settings_text(const std::function<std::string(const std::string& service)>& print_config);

}  // namespace rtd::launcher
