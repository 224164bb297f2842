// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/evaluation/core/report/run_summary.hpp"

namespace rtd::launcher {

/// Writes DIR/report.json and DIR/report.html (self-contained) and returns the numbers. Throws std::runtime_error
/// naming the file when one cannot be written; bad or missing trajectories become notes in both files.
RunSummary write_report(const RunRecord& record, const std::filesystem::path& folder);

/// One run of a comparison.
struct ComparedRun {
  std::string label;  ///< e.g. "filter off"
  RunRecord record;
};

/// Writes one self-contained page that shows runs of the same source beside each other: trajectories in one plot
/// against the ground truth, errors over time, numbers, sample frames. The first run is the baseline. Throws
/// std::runtime_error as above.
void write_comparison_html(const std::vector<ComparedRun>& runs, const std::filesystem::path& file);

}  // namespace rtd::launcher
