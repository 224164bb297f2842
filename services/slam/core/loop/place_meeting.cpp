// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/loop/place_meeting.hpp"

#include <algorithm>

#include "services/slam/core/mapping/mapping_steps.hpp"
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

std::vector<KeyframeId> with_neighbours(const Map& map, KeyframeId keyframe, int count) {
  std::vector<KeyframeId> keyframes = map.best_covisible(keyframe, static_cast<std::size_t>(count));
  keyframes.push_back(keyframe);
  return keyframes;
}

/// What the meeting found: the keyframe's features are the place's landmarks.
int join_met(Map& map, KeyframeId keyframe, const PlaceMeeting& meeting) {
  int joined = 0;
  for (std::uint32_t feature = 0; feature < meeting.landmarks.size(); ++feature) {
    const LandmarkId old = meeting.landmarks[feature];
    if (old == kNoLandmark || map.find_landmark(old) == nullptr) continue;
    const LandmarkId present = map.find_keyframe(keyframe)->landmarks[feature];
    if (present == old) continue;
    if (present != kNoLandmark) {
      map.replace_landmark(present, old);
    } else if (map.add_observation(old, {keyframe, feature})) {
      map.refresh_landmark(old);
    }
    ++joined;
  }
  return joined;
}

}  // namespace

std::optional<PlaceMeeting> meet_place(const Map& map, KeyframeId id, KeyframeId candidate, const SlamConfig& config) {
  const Frame& frame = *map.find_keyframe(id)->frame;
  const LocalMapPtr place = make_local_map(map, candidate, 0, kPlaceKeyframes);
  const Clock no_clock = [] { return std::int64_t{0}; };
  const TrackingContext context{config, no_clock};
  const auto tracking = track_place(frame, *place, context);
  if (!tracking || !tracking->guess.success || tracking->guess.inliers < config.loop.min_inliers) return std::nullopt;
  const double share = found_share(*tracking);
  if (share < config.loop.min_found_share) return std::nullopt;
  return PlaceMeeting{vote_reference(*place, tracking->guess.landmarks), tracking->guess.T_world_camera,
                      tracking->guess.landmarks, tracking->guess.inliers, share};
}

int fuse_place(Map& map, KeyframeId keyframe, const PlaceMeeting& meeting, int neighbours) {
  const std::vector<KeyframeId> here = with_neighbours(map, keyframe, neighbours);
  const std::vector<LandmarkId> there = landmarks_of(map, with_neighbours(map, meeting.place, neighbours));
  int joined = join_met(map, keyframe, meeting);
  for (const KeyframeId id : here) joined += fuse_into(map, id, there);
  for (const LandmarkId id : landmarks_of(map, here)) map.refresh_landmark(id);
  return joined;
}

}  // namespace rtd::slam
