// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rtd::eval::page {

/// page.html with `data` in it: one HTML file with everything inside, which draws the data with its own script. "kind"
/// says what they are: report, comparison or experiment.
std::string filled(const nlohmann::ordered_json& data);

}  // namespace rtd::eval::page
