// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/witnesses.hpp"

#include <algorithm>
#include <bitset>

#include "services/slam/core/tracking/matcher.hpp"

namespace rtd::slam {
namespace {

constexpr int kColumns = 8, kRows = 6;

/// Those of an image in which something is.
class Tiles {
 public:
  explicit Tiles(const Frame& frame) : width_px_(frame.width_px), height_px_(frame.height_px) {}
  void add(double u_px, double v_px) {
    const int column = std::clamp(static_cast<int>(u_px * kColumns / width_px_), 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>(v_px * kRows / height_px_), 0, kRows - 1);
    tiles_.set(static_cast<std::size_t>(row * kColumns + column));
  }
  int count() const { return static_cast<int>(tiles_.count()); }

 private:
  double width_px_, height_px_;
  std::bitset<static_cast<std::size_t>(kColumns) * kRows> tiles_;
};

}  // namespace

WitnessView look_for_witnesses(const Frame& frame, const LocalMap& map, const LocalMapTracking& tracking) {
  Tiles with_features(frame), agreeing(frame), expected(frame), found(frame);
  for (std::size_t i = 0; i < frame.features.size(); ++i) {
    const msg::Feature& feature = frame.features[i];
    with_features.add(feature.u_px, feature.v_px);
    const LandmarkId id = tracking.guess.landmarks[i];
    const LocalLandmark* landmark = id == kNoLandmark ? nullptr : map.find_landmark(id);
    if (landmark == nullptr) continue;
    agreeing.add(feature.u_px, feature.v_px);
    if (landmark->witness) found.add(feature.u_px, feature.v_px);
  }
  const Eigen::Isometry3d T_camera_world = tracking.guess.T_world_camera.inverse();
  for (const LandmarkId id : tracking.visible) {
    const LocalLandmark* landmark = map.find_landmark(id);
    if (landmark == nullptr || !landmark->witness) continue;
    if (const auto seen = project(frame, T_camera_world, landmark->position))
      expected.add(seen->pixel.x(), seen->pixel.y());
  }
  return {with_features.count(), agreeing.count(), expected.count(), found.count(), tracking.guess.witnesses};
}

WitnessVerdict judge_witnesses(const WitnessView& view, const WitnessConfig& config) {
  constexpr int kFewestTiles = 5;
  if (!config.used) return {};
  WitnessVerdict verdict;
  const bool decisive = view.expected >= std::max<double>(kFewestTiles, config.decisive_share * view.with_features);
  const bool found = view.expected >= kFewestTiles && view.found >= config.found_share * view.expected;
  verdict.witnessed = view.witnesses >= config.enough || found;
  verdict.contradicted = decisive && !verdict.witnessed;
  verdict.mostly_unknown = view.agreeing < config.wide_share * view.with_features;
  verdict.carried = verdict.witnessed || (!decisive && !verdict.mostly_unknown);
  return verdict;
}

}  // namespace rtd::slam
