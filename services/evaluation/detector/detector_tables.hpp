// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/evaluation/detector/evaluation_results.hpp"

namespace rtd::launcher {

/// Models side by side, motion levels, thresholds.
std::string labelled_table(const LabelledResults& results);
/// Recall by threshold (one roll) or by roll.
std::string mask_table(const MaskResults& results);
/// How many images, and what was wrong.
std::string input_lines(const InputReport& input, const std::string& partner);

}  // namespace rtd::launcher
