// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/loop/loop_fusion.hpp"

#include <algorithm>

#include "services/slam/core/mapping/landmark_fusion.hpp"

namespace rtd::slam {
namespace {

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

int fuse_place(Map& map, KeyframeId keyframe, const PlaceMeeting& meeting, int neighbours) {
  const std::vector<KeyframeId> here = with_neighbours(map, keyframe, neighbours);
  const std::vector<LandmarkId> there = landmarks_of(map, with_neighbours(map, meeting.place, neighbours));
  int joined = join_met(map, keyframe, meeting);
  for (const KeyframeId id : here) joined += fuse_into(map, id, there);
  for (const LandmarkId id : landmarks_of(map, here)) map.refresh_landmark(id);
  return joined;
}

}  // namespace rtd::slam
