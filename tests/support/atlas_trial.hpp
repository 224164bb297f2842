// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/atlas/core/atlas.hpp"
#include "tests/support/offline_pipeline.hpp"

namespace rtd::test_support {

/// A robot of an atlas trial.
struct TrialRobot {
  std::string name, source;     ///< URI
  std::size_t first_frame = 0;  ///< of the source
  std::size_t max_frames = 0;   ///< 0: all
};

struct TrialResult {
  struct Robot {
    std::string name;
    bool met = false;
    std::uint32_t meetings = 0, keyframes = 0;
    double ate_alone_m = 0, live_alone_m = 0;  ///< RMSE of its own trajectory, at the end and live; aligned for itself
    double ate_joint_m = 0;                    ///< in the joint map, all robots that met aligned together
    double add_ms = 0, straighten_ms = 0;      ///< what a keyframe and a correction cost the atlas, mean CPU
    double kilobytes_per_s = 0;                ///< of features
    double first_pose_s = -1;       ///< its place asked for with every 15th frame: time to the first answer; -1: none
    double first_pose_error_m = 0;  ///< of that answer; only for robots after the first
  };
  std::vector<Robot> robots;
  double ate_joint_m = 0;   ///< RMSE over all robots that met, in the joint map at the end
  double live_joint_m = 0;  ///< of poses as a subscriber has them: by the transform of the moment
  atlas::AtlasCounters counters;
};

/// Robots that walk one after the other, or together, each telling the atlas what it maps. `options`: of all; the
/// source is theirs.
TrialResult run_atlas_trial(const std::vector<TrialRobot>& robots, const OfflineOptions& options,
                            const atlas::AtlasConfig& config = {}, bool together = false);

/// How an atlas does with many robots.
struct ScaleResult {
  std::uint64_t keyframes = 0;        ///< sent
  double cpu_s = 0;                   ///< of the atlas
  double p99_ms = 0, longest_ms = 0;  ///< from a keyframe to the joint map with it, on a core of its own
  std::size_t kept = 0;               ///< keyframes in the joint map at the end
  double peak_mb = 0;                 ///< of this process
  bool all_met = false;
};

/// `robots` walk for `seconds`, faster than time, each again and again along the keyframes of one walk through
/// `source`, with clocks and maps of their own and two keyframes a second. Each half second the joint map is put right,
/// keyframes are requested and the state is made, as by the service.
ScaleResult run_scale_trial(const OfflineOptions& source, int robots, int seconds,
                            const atlas::AtlasConfig& config = {});

}  // namespace rtd::test_support
