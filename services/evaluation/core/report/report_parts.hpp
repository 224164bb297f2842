// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/evaluation/core/report/html.hpp"
#include "services/evaluation/core/report/run_summary.hpp"

namespace rtd::eval {

inline constexpr std::size_t kShownSamples = 6;    ///< frames of a run that a comparison shows
inline constexpr std::size_t kSliderSamples = 24;  ///< and that the page of the run shows

/// The time axis that all charts of a run share.
struct RunTime {
  std::int64_t start_ns = 0;  ///< stamp of the first frame
  double duration_s = 0;      ///< to the last frame, source time
};
RunTime run_time(const Run& run, const RunSummary& summary);
/// Of a frame, since the first one.
double source_time_s(const run_record::FrameRecord& frame, const RunTime& time);
/// The ground truth of that time.
Trajectory truth_during(const RunSummary& summary, const RunTime& time);

/// Features kept and removed per frame as stacked areas, inliers of tracking as a line, frames without pose as red
/// bands.
std::string points_chart(const Run& run, const RunSummary& summary);

/// Latency of every frame over time with its distribution, p50 and p99.
std::string latency_chart(const Run& run, const RunSummary& summary);

/// One row per stage that ran: bar to the median, whisker to the 99th percentile.
std::string stage_chart(const RunSummary& summary);

/// A kept frame with its features drawn on it: green kept, red removed. Empty when the JPEG cannot be read.
std::string sample_picture(const run_record::SampleFrame& sample);

/// "12.34 ms" style text of a number, "unknown" when not finite.
std::string number_text(double value, int decimals, const std::string& unit);
/// Share as percentage: "99.52 %".
std::string percent_text(double fraction);

/// At most `wanted` sample frames, evenly spread, as figures with captions.
std::vector<html::Figure> sample_figures(const Run& run, std::size_t wanted);

}  // namespace rtd::eval
