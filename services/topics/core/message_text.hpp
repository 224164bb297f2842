// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace rtd::topics {

/// A message (common/ros2/message_json.hpp) as YAML: one line per field, arrays of values in one line, "---" at
/// the end.
std::string message_text(const nlohmann::ordered_json& message);

}  // namespace rtd::topics
