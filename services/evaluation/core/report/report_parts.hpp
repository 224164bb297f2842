// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/evaluation/core/report/html.hpp"
#include "services/evaluation/core/report/run_summary.hpp"

namespace rtd::launcher {

/// Parts that the page of one run and the page of a comparison share.

/// "12.34 ms" style text of a number, "unknown" when not finite.
std::string number_text(double value, int decimals, const std::string& unit);
/// Share as percentage: "99.52 %".
std::string percent_text(double fraction);

/// ATE and RPE of an evaluation with their statistics.
html::Table accuracy_table(const eval::Evaluation& evaluation);

/// At most `wanted` sample frames, evenly spread, as figures with captions.
std::vector<html::Figure> sample_figures(const RunRecord& record, std::size_t wanted);

}  // namespace rtd::launcher
