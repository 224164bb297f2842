// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/witnesses.hpp"

#include <algorithm>

#include "common/msg/stamps.hpp"
#include "services/slam/core/map/tiles.hpp"
#include "services/slam/core/tracking/matcher.hpp"

namespace rtd::slam {

WitnessView look_for_witnesses(const Frame& frame, const LocalMap& map, const LocalMapTracking& tracking) {
  Tiles with_features, agreeing, expected, found;
  const auto add = [&](Tiles& tiles, double u_px, double v_px) { tiles.set(tile_of(frame, u_px, v_px)); };
  for (std::size_t i = 0; i < frame.features.size(); ++i) {
    const msg::Feature& feature = frame.features[i];
    add(with_features, feature.u_px, feature.v_px);
    const LandmarkId id = tracking.guess.landmarks[i];
    const LocalLandmark* landmark = id == kNoLandmark ? nullptr : map.find_landmark(id);
    if (landmark == nullptr) continue;
    add(agreeing, feature.u_px, feature.v_px);
    if (landmark->witness) add(found, feature.u_px, feature.v_px);
  }
  const Eigen::Isometry3d T_camera_world = tracking.guess.T_world_camera.inverse();
  for (const LandmarkId id : tracking.visible) {
    const LocalLandmark* landmark = map.find_landmark(id);
    if (landmark == nullptr || !landmark->witness) continue;
    if (const auto seen = project(frame, T_camera_world, landmark->position))
      add(expected, seen->pixel.x(), seen->pixel.y());
  }
  const auto count = [](const Tiles& tiles) { return static_cast<int>(tiles.count()); };
  return {count(with_features), count(agreeing), count(expected), count(found), tracking.guess.witnesses};
}

WitnessVerdict WitnessJudge::judge(const WitnessView& view, std::int64_t stamp_ns) {
  constexpr int kFewestTiles = 5;
  if (!config_.used) return {};
  WitnessVerdict verdict;
  const bool decisive = view.expected >= std::max<double>(kFewestTiles, config_.decisive_share * view.with_features);
  const bool found = view.expected >= kFewestTiles && view.found >= config_.found_share * view.expected;
  verdict.witnessed = view.witnesses >= config_.enough || found;
  verdict.contradicted = decisive && !verdict.witnessed;
  verdict.mostly_unknown = view.agreeing < config_.wide_share * view.with_features;
  if (verdict.contradicted) contradicted_ns_ = stamp_ns;
  if (verdict.witnessed || (contradicted_ns_ && msg::minus_s(stamp_ns, *contradicted_ns_) > config_.settle_s)) forget();
  verdict.doubtful = contradicted_ns_.has_value();
  verdict.carried = verdict.witnessed || (!decisive && !verdict.mostly_unknown && !verdict.doubtful);
  return verdict;
}

}  // namespace rtd::slam
