// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "services/evaluation/detector/evaluation_results.hpp"

namespace rtd::launcher {

/// docs/evaluation.md lists the keys.
nlohmann::json to_json(const LabelledResults& results);
nlohmann::json to_json(const MaskResults& results);

}  // namespace rtd::launcher
