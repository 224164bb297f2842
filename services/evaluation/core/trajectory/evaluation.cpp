// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/evaluation.hpp"

#include <cmath>

namespace rtd::eval {
namespace {

Coverage measure_coverage(const Trajectory& estimate, const Trajectory& groundtruth, const EvaluationOptions& options,
                          const std::optional<std::vector<std::int64_t>>& frames_ns) {
  std::vector<std::int64_t> poses_ns = stamps_of(estimate);
  if (frames_ns) return coverage_of_frames(*frames_ns, poses_ns);
  if (groundtruth.empty()) return {};
  const std::int64_t offset_ns = std::llround(options.association.offset_s * 1e9);
  for (std::int64_t& stamp_ns : poses_ns) stamp_ns += offset_ns;
  return coverage_of_span(groundtruth.front().stamp_ns, groundtruth.back().stamp_ns, poses_ns, options.max_gap_s);
}

}  // namespace

Evaluation evaluate(const Trajectory& estimate, const Trajectory& groundtruth, const EvaluationOptions& options,
                    const std::optional<std::vector<std::int64_t>>& frames_ns) {
  Evaluation evaluation;
  evaluation.estimate_poses = estimate.size();
  evaluation.groundtruth_poses = groundtruth.size();
  evaluation.ate = ate(estimate, groundtruth, {options.association, options.alignment});
  const auto rpe_per = [&](RpeUnit unit) {
    return rpe(estimate, groundtruth, {1.0, unit, options.association.offset_s, evaluation.ate.alignment.scale});
  };
  evaluation.rpe_per_second = rpe_per(RpeUnit::kSeconds);
  evaluation.rpe_per_frame = rpe_per(RpeUnit::kFrames);
  evaluation.rpe_per_metre = rpe_per(RpeUnit::kMetres);
  evaluation.coverage = measure_coverage(estimate, groundtruth, options, frames_ns);
  return evaluation;
}

}  // namespace rtd::eval
