// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "services/evaluation/detector/evaluate.hpp"

namespace rtd::eval {

/// Labels: models side by side, motion levels, thresholds. Masks: recall by threshold (one roll) or by roll.
std::string to_table(const LabelledResults& results);
std::string to_table(const MaskResults& results);

/// Number of images, and the problems with the input.
std::string input_lines(const LabelledResults& results);
std::string input_lines(const MaskResults& results);

/// docs/evaluation.md lists the keys.
nlohmann::json to_json(const LabelledResults& results);
nlohmann::json to_json(const MaskResults& results);

}  // namespace rtd::eval
