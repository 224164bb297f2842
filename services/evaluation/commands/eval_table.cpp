// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/commands/eval_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

namespace rtd::launcher {
namespace {

constexpr double kRadToDeg = 180 / std::numbers::pi;
constexpr std::size_t kShownSpans = 5;

double seconds(std::int64_t stamp_ns) {
  return static_cast<double>(stamp_ns) * 1e-9;
}

std::string row(const std::string& name, const eval::Statistics& s, double factor, const char* unit) {
  if (s.count == 0) return fmt::format("{:<22} no pairs\n", name);
  return fmt::format("{:<22} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f} {:<4} {:>6}\n", name,
                     s.rmse * factor, s.mean * factor, s.median * factor, s.std_dev * factor, s.min * factor,
                     s.max * factor, unit, s.count);
}

std::string rpe_rows(const std::string& name, const eval::RpeResult& rpe) {
  return row(name, rpe.translation_m, 1, "m") + row("", rpe.rotation_rad, kRadToDeg, "deg");
}

std::string coverage_rows(const eval::Coverage& coverage, std::int64_t start_ns) {
  std::string text = coverage.frames > 0 ? fmt::format("coverage               {:.2f} % ({} of {} frames)\n",
                                                       100 * coverage.fraction, coverage.tracked, coverage.frames)
                                         : fmt::format("coverage               {:.2f} % of the ground truth's time\n",
                                                       100 * coverage.fraction);
  for (std::size_t i = 0; i < std::min(coverage.lost.size(), kShownSpans); ++i) {
    const eval::LostSpan& span = coverage.lost[i];
    text += fmt::format("  without poses        {:.2f} s to {:.2f} s after the start",
                        seconds(span.first_ns - start_ns), seconds(span.last_ns - start_ns));
    text += span.frames > 0 ? fmt::format(" ({} frames)\n", span.frames) : "\n";
  }
  if (coverage.lost.size() > kShownSpans) {
    text += fmt::format("  and {} more (--json lists all)\n", coverage.lost.size() - kShownSpans);
  }
  return text;
}

std::string alignment_rows(const eval::Alignment& alignment) {
  std::string text;
  if (alignment.scale != 1) text += fmt::format("scale                  {:.6f}\n", alignment.scale);
  if (!alignment.unique) {
    text += "note                   poses lie on one line or point: the alignment is one of many, ATE is optimistic\n";
  }
  return text;
}

}  // namespace

std::string evaluation_table(const eval::Evaluation& e, const EvalOptions& options) {
  const std::int64_t start_ns = e.ate.points.empty() ? 0 : e.ate.points.front().stamp_ns;
  return fmt::format("estimate               {} ({} poses)\nground truth           {} ({} poses)\n", options.estimate,
                     e.estimate_poses, options.groundtruth, e.groundtruth_poses) +
         coverage_rows(e.coverage, start_ns) + alignment_rows(e.ate.alignment) +
         fmt::format("\n{:<22} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:<4} {:>6}\n", "", "rmse", "mean", "median", "std",
                     "min", "max", "", "pairs") +
         row(options.scale ? "ATE (Sim(3))" : "ATE (SE(3))", e.ate.error_m, 1, "m") +
         rpe_rows("RPE per second", e.rpe_per_second) + rpe_rows("RPE per frame", e.rpe_per_frame) +
         rpe_rows("RPE per metre", e.rpe_per_metre);
}

std::string explain_no_pairs(const eval::Trajectory& estimate, const eval::Trajectory& groundtruth,
                             const EvalOptions& options) {
  const auto span = [](const eval::Trajectory& t) {
    return fmt::format("{:.6f} to {:.6f} s", seconds(t.front().stamp_ns), seconds(t.back().stamp_ns));
  };
  return fmt::format(
      "rtd eval: no poses associate within {} s.\n"
      "  estimate     {}: {}\n"
      "  ground truth {}: {}\n"
      "Are these files of the same sequence? A constant difference of clocks goes into --offset (added to the\n"
      "estimate; the starts differ by {:.6f} s), a coarse ground truth needs a larger --max-difference.\n",
      options.max_difference_s, options.estimate, span(estimate), options.groundtruth, span(groundtruth),
      seconds(groundtruth.front().stamp_ns - estimate.front().stamp_ns));
}

}  // namespace rtd::launcher
