// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/evaluation/core/plot/svg.hpp"
#include "services/evaluation/detector/evaluation_results.hpp"

namespace rtd::launcher {

/// Precision and recall of the high motion level over the confidence threshold, a colour for each model.
plot::Svg threshold_plot(const LabelledResults& results);
/// Share of marked pixels in boxes over roll, a colour for each model; dashed as the camera sees it, solid upright.
plot::Svg roll_plot(const MaskResults& results);

/// Self-contained pages with the tables.
std::string labelled_html(const LabelledResults& results);
std::string mask_html(const MaskResults& results);

}  // namespace rtd::launcher
