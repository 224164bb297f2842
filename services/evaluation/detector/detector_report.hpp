// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "services/evaluation/core/plot/svg.hpp"
#include "services/evaluation/detector/evaluate.hpp"

namespace rtd::eval {

/// Models side by side, motion levels, thresholds.
std::string labelled_table(const LabelledResults& results);
/// Recall by threshold (one roll) or by roll.
std::string mask_table(const MaskResults& results);
/// Number of images, and the problems with the input.
std::string input_lines(const InputReport& input, const std::string& partner);

/// docs/evaluation.md lists the keys.
nlohmann::json to_json(const LabelledResults& results);
nlohmann::json to_json(const MaskResults& results);

/// Precision and recall of the high motion level over the confidence threshold, a colour for each model.
plot::Svg threshold_plot(const LabelledResults& results);
/// Share of marked pixels in boxes over roll, a colour for each model; dashed as the camera sees it, solid upright.
plot::Svg roll_plot(const MaskResults& results);

/// Self-contained pages with the tables.
std::string labelled_html(const LabelledResults& results);
std::string mask_html(const MaskResults& results);

}  // namespace rtd::eval
