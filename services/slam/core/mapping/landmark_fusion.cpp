// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/mapping/mapping_steps.hpp"

#include <algorithm>

#include "common/vision/features.hpp"
#include "services/slam/core/map/frame.hpp"
#include "services/slam/core/tracking/matcher.hpp"

namespace rtd::slam {
namespace {

/// The keyframe's best covisible ones and their best five.
std::vector<KeyframeId> select_targets(const Map& map, KeyframeId keyframe, int neighbours) {
  constexpr std::size_t kSecondNeighbours = 5;
  std::vector<KeyframeId> targets = map.best_covisible(keyframe, static_cast<std::size_t>(neighbours));
  const std::size_t direct = targets.size();
  for (std::size_t i = 0; i < direct; ++i) {
    for (const KeyframeId second : map.best_covisible(targets[i], kSecondNeighbours)) {
      if (second != keyframe && std::find(targets.begin(), targets.end(), second) == targets.end()) {
        targets.push_back(second);
      }
    }
  }
  return targets;
}

bool sees(const Landmark& landmark, KeyframeId keyframe) {
  return std::any_of(landmark.observations.begin(), landmark.observations.end(),
                     [keyframe](const Observation& o) { return o.keyframe == keyframe; });
}

/// The feature that shows the landmark: near its projection, within the reprojection chi2, most similar.
std::optional<std::uint32_t> find_feature(const Frame& frame, const SearchPoint& point) {
  constexpr int kMaxHamming = 50;
  int best = kMaxHamming + 1;
  std::optional<std::uint32_t> found;
  frame.grid.for_each(point.window, [&](std::uint32_t i) {
    const msg::Feature& feature = frame.features[i];
    const double du = feature.u_px - point.window.u_px, dv = feature.v_px - point.window.v_px;
    const double disparity_error =
        feature.depth_m > 0 ? frame.camera.disparity_px_m * (1.0 / feature.depth_m - point.inverse_depth_per_m) : 0.0;
    const double chi2 =
        (du * du + dv * dv + disparity_error * disparity_error) / (sigma_px(feature.octave) * sigma_px(feature.octave));
    if (chi2 > (feature.depth_m > 0 ? kMaxChi2Rgbd : kMaxChi2Pixel)) return;
    const int hamming = vision::hamming_distance(feature.descriptor, *point.descriptor);
    if (hamming >= best) return;
    best = hamming;
    found = i;
  });
  return found;
}

}  // namespace

int fuse_into(Map& map, KeyframeId target, const std::vector<LandmarkId>& landmarks) {
  constexpr double kRadius_px = 3.0;
  const Eigen::Isometry3d T_world_camera = map.find_keyframe(target)->T_world_camera;
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  const FramePtr frame = map.find_keyframe(target)->frame;
  int merged = 0;
  for (const LandmarkId id : landmarks) {
    const Landmark* landmark = map.find_landmark(id);
    if (landmark == nullptr || sees(*landmark, target)) continue;
    const auto view =
        predict_view(*frame, T_world_camera, T_camera_world,
                     {landmark->position, landmark->normal, landmark->min_distance_m, landmark->max_distance_m});
    if (!view) continue;
    const auto feature = find_feature(*frame, make_search_point(*view, kRadius_px, landmark->descriptor, 0));
    if (!feature) continue;
    const LandmarkId present = map.find_keyframe(target)->landmarks[*feature];
    if (present == kNoLandmark) {
      map.add_observation(id, {target, *feature});
    } else {
      const bool keep_present = map.find_landmark(present)->observations.size() > landmark->observations.size();
      map.replace_landmark(keep_present ? id : present, keep_present ? present : id);
      ++merged;
    }
  }
  return merged;
}

std::vector<LandmarkId> landmarks_of(const Map& map, const std::vector<KeyframeId>& keyframes) {
  std::vector<LandmarkId> landmarks;
  for (const KeyframeId id : keyframes) {
    for (const LandmarkId landmark : map.find_keyframe(id)->landmarks) {
      if (landmark != kNoLandmark) landmarks.push_back(landmark);
    }
  }
  std::sort(landmarks.begin(), landmarks.end());
  landmarks.erase(std::unique(landmarks.begin(), landmarks.end()), landmarks.end());
  return landmarks;
}

int fuse_landmarks(Map& map, KeyframeId keyframe, int neighbours) {
  const std::vector<KeyframeId> targets = select_targets(map, keyframe, neighbours);
  int merged = 0;
  for (const KeyframeId target : targets) merged += fuse_into(map, target, landmarks_of(map, {keyframe}));
  merged += fuse_into(map, keyframe, landmarks_of(map, targets));
  for (const LandmarkId landmark : landmarks_of(map, {keyframe})) map.refresh_landmark(landmark);
  return merged;
}

}  // namespace rtd::slam
