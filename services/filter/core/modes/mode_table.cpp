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

constexpr NamedTechnique kTechniques[] = {
    {"motion_levels", &Techniques::motion_levels, "every class of the table counts as high"},
    {"depth_masks", &Techniques::depth_masks, "the whole box is the object"},
    {"flat_objects", &Techniques::flat_objects, "a poster of a person is a person"},
    {"depth_check", &Techniques::depth_check, "no multi-view check of range images"},
    {"feature_votes", &Techniques::feature_votes, "displaced features do not vote"},
    {"look_back", &Techniques::look_back, "no look back over a second for very slow movers"},
    {"arrivals", &Techniques::arrivals, "old views go on condemning what has come and stopped"},
    {"object_drift", &Techniques::object_drift, "a person's features vote one by one"},
    {"noise_aware_tau", &Techniques::noise_aware_tau, "the paper's 0.4 m at every depth"},
    {"mover_memory", &Techniques::mover_memory, "movers are found anew in each frame"},
    {"mover_tracks", &Techniques::mover_tracks, "movers that come back into view are new"},
    {"surface_poses", &Techniques::surface_poses, "surfaces do not propose the camera's motion"},
    {"belief", &Techniques::belief, "static probability from one frame alone"},
    {"resting_objects", &Techniques::resting_objects, "high classes are never used"},
    {"feature_weights", &Techniques::feature_weights, "what is kept weighs 1"},
    {"box_tracks", &Techniques::box_tracks, "only the boxes of the frame itself"},
    {"mask_flow", &Techniques::mask_flow, "masks move with the predicted box"},
    {"roll_distrust", &Techniques::roll_distrust, "an empty answer is always believed"},
    {"more_features", &Techniques::more_features, "as many features whatever is masked"},
    {"keep_doubtful", &Techniques::keep_doubtful, "too few features stay too few"},
};

using T = Techniques;

template <class Judge>
std::unique_ptr<ModeJudge> make(const FilterConfig& config) {
  return std::make_unique<Judge>(config);
}

Techniques only(std::initializer_list<bool T::*> chosen) {
  Techniques techniques;
  for (const NamedTechnique& technique : all_techniques()) {
    techniques.*technique.on = std::find(chosen.begin(), chosen.end(), technique.on) != chosen.end();
  }
  return techniques;
}

Techniques everything() {
  Techniques techniques;
  for (const NamedTechnique& technique : all_techniques()) techniques.*technique.on = true;
  return techniques;
}

const std::vector<ModeEntry>& table() {
  static const std::vector<ModeEntry> entries{
      {FilterMode::kOff, "off", only({}), make<RtdJudge>},
      {FilterMode::kSemantic, "semantic",
       only({&T::motion_levels, &T::depth_masks, &T::box_tracks, &T::mask_flow, &T::roll_distrust, &T::more_features}),
       make<RtdJudge>},
      {FilterMode::kGeometry, "geometry",
       only({&T::depth_check, &T::feature_votes, &T::look_back, &T::arrivals, &T::noise_aware_tau, &T::mover_memory,
             &T::mover_tracks, &T::surface_poses, &T::belief, &T::feature_weights, &T::more_features,
             &T::keep_doubtful}),
       make<RtdJudge>},
      {FilterMode::kEpipolar, "epipolar", only({&T::motion_levels, &T::depth_masks}), make<EpipolarJudge>},
      {FilterMode::kRtdPaper, "rtd-paper", only({&T::motion_levels}), make<PaperJudge>},
      {FilterMode::kRtd, "rtd", everything(), make<RtdJudge>},
  };
  return entries;
}

}  // namespace

std::span<const NamedTechnique> all_techniques() {
  return kTechniques;
}

Techniques in_common(const Techniques& a, const Techniques& b) {
  Techniques both;
  for (const NamedTechnique& technique : kTechniques) both.*technique.on = a.*technique.on && b.*technique.on;
  return both;
}

FilterConfig with_techniques_applied(FilterConfig config) {
  const Techniques& on = config.techniques;
  if (!on.depth_masks) config.masks.whole_boxes = true;
  if (!on.flat_objects) config.masks.min_outline_share = 0;  // no outline is flat enough
  if (!on.depth_check) config.geometry.max_views = 0;        // nobody to ask
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
  if (!on.mover_memory) config.geometry.memory_frames = config.geometry.loose_memory_frames = 1;  // this frame itself
  if (!on.surface_poses) config.ego_motion.max_proposals = 0;
  if (!on.more_features) config.fusion.boost = 1;
  if (!on.keep_doubtful) config.fusion.min_static_features = 0;
  return config;
}

std::span<const ModeEntry> all_modes() {
  return table();
}

const ModeEntry& entry_of(FilterMode mode) {
  return *std::find_if(table().begin(), table().end(), [mode](const ModeEntry& entry) { return entry.mode == mode; });
}

bool looks_at_boxes(FilterMode mode) {
  return mode != FilterMode::kOff && mode != FilterMode::kGeometry;
}

FilterConfig effective_config(FilterConfig config) {
  config.techniques = in_common(config.techniques, entry_of(config.mode).techniques);
  return with_techniques_applied(std::move(config));
}

}  // namespace rtd::filter
