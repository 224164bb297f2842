// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/sightings.hpp"

#include <cmath>
#include <numbers>

namespace rtd::filter {
namespace {

constexpr double kKeypointSigmaPx = 0.7;  // at octave 0

PointSighting to_sighting(const FeatureMatch& match, const EgoMotionInput& input) {
  const msg::Feature& f = input.current.features[match.current];
  return {match.p_world, {f.u_px, f.v_px}, f.depth_m, displacement_sigma_px(f.octave), input.cluster_of[match.current]};
}

}  // namespace

double displacement_sigma_px(int octave) {
  return std::numbers::sqrt2 * kKeypointSigmaPx * std::pow(1.2, octave);
}

std::vector<FeatureMatch> usable(const std::vector<FeatureMatch>& matches, const EgoMotionInput& input,
                                 const std::vector<char>& moving_cluster, std::size_t limit) {
  std::vector<FeatureMatch> kept;
  for (const FeatureMatch& match : matches) {
    const int cluster = input.cluster_of[match.current];
    if (!match.reference_static || input.excluded[match.current] != 0) continue;
    if (cluster >= 0 && moving_cluster[static_cast<std::size_t>(cluster)] != 0) continue;
    kept.push_back(match);
  }
  if (kept.size() <= limit) return kept;
  std::vector<FeatureMatch> thinned;
  for (std::size_t i = 0; i < limit; ++i) thinned.push_back(kept[i * kept.size() / limit]);
  return thinned;
}

std::vector<PointSighting> to_sightings(const std::vector<FeatureMatch>& matches, const EgoMotionInput& input) {
  std::vector<PointSighting> sightings;
  sightings.reserve(matches.size());
  for (const FeatureMatch& match : matches) sightings.push_back(to_sighting(match, input));
  return sightings;
}

}  // namespace rtd::filter
