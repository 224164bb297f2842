// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/coverage.hpp"

#include <algorithm>
#include <cmath>

#include "services/evaluation/core/trajectory/association.hpp"

namespace rtd::eval {
namespace {

constexpr double kSameFrameS = 0.001;

}  // namespace

Coverage coverage_of_frames(const std::vector<std::int64_t>& frames_ns, const std::vector<std::int64_t>& poses_ns) {
  Coverage coverage;
  coverage.frames = frames_ns.size();
  std::vector<bool> tracked(frames_ns.size());
  for (const MatchedPair& pair : associate(frames_ns, poses_ns, {kSameFrameS, 0.0})) tracked[pair.groundtruth] = true;
  for (std::size_t i = 0; i < frames_ns.size(); ++i) {
    if (tracked[i]) {
      ++coverage.tracked;
    } else if (i == 0 || tracked[i - 1]) {
      coverage.lost.push_back({frames_ns[i], frames_ns[i], 1});
    } else {
      coverage.lost.back().last_ns = frames_ns[i];
      ++coverage.lost.back().frames;
    }
  }
  if (coverage.frames > 0)
    coverage.fraction = static_cast<double>(coverage.tracked) / static_cast<double>(coverage.frames);
  return coverage;
}

Coverage coverage_of_span(std::int64_t first_ns, std::int64_t last_ns, const std::vector<std::int64_t>& poses_ns,
                          double max_gap_s) {
  Coverage coverage;
  if (last_ns <= first_ns) return coverage;
  std::vector<std::int64_t> marks_ns{first_ns};
  for (const std::int64_t pose_ns : poses_ns) {
    if (pose_ns < first_ns || pose_ns > last_ns) continue;
    marks_ns.push_back(pose_ns);
    ++coverage.tracked;
  }
  marks_ns.push_back(last_ns);
  const std::int64_t max_gap_ns = std::llround(max_gap_s * 1e9);
  std::int64_t covered_ns = 0;
  for (std::size_t i = 1; i < marks_ns.size(); ++i) {
    const std::int64_t gap_ns = marks_ns[i] - marks_ns[i - 1];
    if (gap_ns > max_gap_ns || coverage.tracked == 0) {
      coverage.lost.push_back({marks_ns[i - 1], marks_ns[i], 0});
    } else {
      covered_ns += gap_ns;
    }
  }
  coverage.fraction = static_cast<double>(covered_ns) / static_cast<double>(last_ns - first_ns);
  return coverage;
}

}  // namespace rtd::eval
