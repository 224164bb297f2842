// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/loop/place_verification.hpp"

#include <algorithm>

#include "services/slam/core/tracking/tracker.hpp"

namespace rtd::slam {
namespace {

constexpr std::size_t kPlaceKeyframes = 20;  ///< candidate and its neighbours: what one can see from about there

/// Landmarks found over those that should be visible; some of these are hidden by nearer things.
double found_share(const LocalMapTracking& tracking) {
  return tracking.visible.empty()
             ? 0
             : static_cast<double>(tracking.guess.inliers) / static_cast<double>(tracking.visible.size());
}

}  // namespace

std::optional<PlaceMeeting> meet_place(const Map& map, KeyframeId id, KeyframeId candidate, const SlamConfig& config) {
  const Frame& frame = *map.find_keyframe(id)->frame;
  const LocalMapPtr place = make_local_map(map, candidate, 0, kPlaceKeyframes);
  const Clock no_clock = [] { return std::int64_t{0}; };
  const StatisticsById no_statistics;
  const TrackingContext context{config, no_clock, no_statistics};
  const PoseGuess guess = track_keyframe(frame, place->keyframes.front(), *place, context);
  if (!guess.success) return std::nullopt;
  LocalMapTracking tracking = track_local_map(frame, *place, guess, context);
  if (!tracking.guess.success) return std::nullopt;
  tracking = track_local_map(frame, *place, tracking.guess, context);
  const double share = found_share(tracking);
  if (!tracking.guess.success || tracking.guess.inliers < config.loop.min_inliers ||
      share < config.loop.min_found_share) {
    return std::nullopt;
  }
  return PlaceMeeting{vote_reference(*place, tracking.guess.landmarks), tracking.guess.T_world_camera,
                      tracking.guess.landmarks, tracking.guess.inliers, share};
}

}  // namespace rtd::slam
