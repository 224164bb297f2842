// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/modes/mode_table.hpp"

#include <algorithm>
#include <initializer_list>
#include <vector>

#include "services/filter/core/modes/techniques.hpp"

namespace rtd::filter {
namespace {

using T = Techniques;

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
      {FilterMode::kOff, "off", only({})},
      {FilterMode::kSemantic, "semantic",
       only({&T::motion_levels, &T::depth_masks, &T::box_tracks, &T::mask_flow, &T::roll_distrust, &T::more_features})},
      {FilterMode::kGeometry, "geometry",
       only({&T::depth_check, &T::feature_votes, &T::look_back, &T::arrivals, &T::noise_aware_tau, &T::mover_memory,
             &T::mover_tracks, &T::surface_poses, &T::belief, &T::feature_weights, &T::more_features,
             &T::keep_doubtful})},
      {FilterMode::kEpipolar, "epipolar", only({&T::motion_levels, &T::depth_masks})},
      {FilterMode::kRtdPaper, "rtd-paper", only({&T::motion_levels})},
      {FilterMode::kRtd, "rtd", everything()},
  };
  return entries;
}

}  // namespace

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
