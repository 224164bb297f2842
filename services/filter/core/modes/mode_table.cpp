// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/modes/mode_table.hpp"

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <vector>

#include "services/filter/core/modes/epipolar_judge.hpp"
#include "services/filter/core/modes/paper_judge.hpp"
#include "services/filter/core/modes/rtd_judge.hpp"

namespace rtd::filter {
namespace {

constexpr double kPaperTauM = 0.4;  // section III-A

using T = Techniques;

template <class Judge>
std::unique_ptr<ModeJudge> make(const FilterConfig& config) {
  return std::make_unique<Judge>(config);
}

Techniques only(std::initializer_list<bool T::*> chosen) {
  Techniques techniques;
  for (const NamedTechnique& technique : kTechniques) {
    techniques.*technique.on = std::find(chosen.begin(), chosen.end(), technique.on) != chosen.end();
  }
  return techniques;
}

Techniques everything() {
  Techniques techniques;
  for (const NamedTechnique& technique : kTechniques) techniques.*technique.on = true;
  return techniques;
}

const std::vector<ModeEntry>& table() {
  static const std::vector<ModeEntry> entries{
      {FilterMode::kOff, only({}), make<RtdJudge>},
      {FilterMode::kSemantic,
       only({&T::motion_levels, &T::depth_masks, &T::object_holes, &T::box_tracks, &T::mask_flow, &T::more_features}),
       make<RtdJudge>},
      {FilterMode::kGeometry,
       only({&T::depth_check, &T::feature_votes, &T::look_back, &T::arrivals, &T::noise_aware_tau, &T::mover_memory,
             &T::mover_tracks, &T::surface_poses, &T::belief, &T::feature_weights, &T::more_features,
             &T::keep_doubtful}),
       make<RtdJudge>},
      {FilterMode::kEpipolar, only({&T::motion_levels, &T::depth_masks}), make<EpipolarJudge>},
      {FilterMode::kRtdPaper, only({&T::motion_levels}), make<PaperJudge>},
      {FilterMode::kRtd, everything(), make<RtdJudge>},
  };
  return entries;
}

/// Only those that are on in both.
Techniques in_common(const Techniques& a, const Techniques& b) {
  Techniques both;
  for (const NamedTechnique& technique : kTechniques) both.*technique.on = a.*technique.on && b.*technique.on;
  return both;
}

/// What switches that are off mean in numbers: a technique that only weighs evidence needs no branch in the algorithm,
/// its numbers are such that it has no effect. `config.techniques` is kept for those that do need a branch.
FilterConfig with_techniques_applied(FilterConfig config) {
  const Techniques& on = config.techniques;
  if (!on.depth_masks) config.masks.whole_boxes = true;
  config.masks.holes = on.object_holes;
  if (!on.flat_objects) config.masks.min_outline_share = 0;  // no outline is flat enough
  if (!on.depth_check) config.geometry.max_views = 0;        // no view to compare with
  if (!on.feature_votes) {
    config.geometry.min_moving_features = config.geometry.min_creeping_features = std::numeric_limits<int>::max();
  }
  if (!on.look_back) config.geometry.min_creeping_features = std::numeric_limits<int>::max();
  if (!on.arrivals) config.geometry.max_unsettled_share = -1;  // no share is small enough
  if (!on.object_drift) config.belief.drift_sigmas = std::numeric_limits<double>::infinity();
  if (!on.noise_aware_tau) {
    config.geometry.tau_floor_m = kPaperTauM;
    config.geometry.tau_sigmas = 0;
  }
  if (!on.mover_memory) config.geometry.memory_s = config.geometry.loose_memory_s = 0.01;  // this frame itself
  if (!on.surface_poses) config.ego_motion.max_proposals = 0;
  if (!on.more_features) config.fusion.boost = 1;
  if (!on.keep_doubtful) config.fusion.min_static_features = 0;
  return config;
}

}  // namespace

std::span<const ModeEntry> all_modes() {
  return table();
}

const ModeEntry& entry_of(FilterMode mode) {
  return *std::find_if(table().begin(), table().end(), [mode](const ModeEntry& entry) { return entry.mode == mode; });
}

FilterConfig effective_config(FilterConfig config) {
  config.techniques = in_common(config.techniques, entry_of(config.mode).techniques);
  return with_techniques_applied(std::move(config));
}

}  // namespace rtd::filter
