// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/tracking_steps.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/vision/features.hpp"
#include "services/slam/core/map/frame.hpp"
#include "services/slam/core/tracking/matcher.hpp"

namespace rtd::slam {
namespace {

vision::SearchWindow window_around(const Projection& projection, double radius_px) {
  return {static_cast<float>(projection.pixel.x()), static_cast<float>(projection.pixel.y()),
          static_cast<float>(radius_px), 0, kOctaves};
}

/// Whether most matches near a feature fit the pose: then the one that does not is wrong itself.
bool neighbours_fit(const Frame& frame, const LocalMapTracking& tracking, const Association& rejected) {
  constexpr float kNear_px = 60.0F;
  constexpr int kMinNeighbours = 4;
  const msg::Feature& at = frame.features[rejected.feature];
  const auto near = [&](std::uint32_t i) {
    return std::abs(frame.features[i].u_px - at.u_px) < kNear_px &&
           std::abs(frame.features[i].v_px - at.v_px) < kNear_px;
  };
  int fit = 0, others = 0;
  for (std::uint32_t i = 0; i < tracking.guess.landmarks.size(); ++i) {
    if (tracking.guess.landmarks[i] != kNoLandmark && near(i)) ++fit;
  }
  for (const Association& other : tracking.rejected) {
    if (other.feature != rejected.feature && near(other.feature)) ++others;
  }
  return fit >= kMinNeighbours && fit > 2 * others;
}

/// Whether the filter removed a feature that looks like the landmark, at its place or wherever it has been carried
/// within a few pixels.
bool removed_by_filter(const Frame& frame, const LocalLandmark& landmark, const Projection& projection) {
  constexpr double kRadius_px = 12.0;
  constexpr int kMaxHamming = 50;
  bool removed = false;
  frame.removed_grid.for_each(window_around(projection, kRadius_px), [&](std::uint32_t i) {
    removed = removed || vision::hamming_distance(frame.removed[i].descriptor, landmark.descriptor) <= kMaxHamming;
  });
  return removed;
}

/// Whether all depth measured around the projection lies clearly behind the landmark, which has gone.
bool seen_through(const Frame& frame, const Projection& projection) {
  constexpr double kRadius_px = 8.0;
  constexpr int kMinReadings = 2;
  const double margin_m = 0.08 + 0.01 * projection.z_m * projection.z_m;  // as dynamic_points.md Eq. (4)
  int behind = 0, others = 0;
  frame.grid.for_each(window_around(projection, kRadius_px), [&](std::uint32_t i) {
    const double depth_m = frame.features[i].depth_m;
    if (depth_m > 0) ++(depth_m > projection.z_m + margin_m ? behind : others);
  });
  return behind >= kMinReadings && others == 0;
}

}  // namespace

std::vector<LandmarkEvidence> judge_landmarks(const Frame& frame, const LocalMap& map, const LocalMapTracking& tracking,
                                              const BeliefConfig& config) {
  std::vector<LandmarkEvidence> evidence;
  std::vector<LandmarkId> matched;
  for (std::uint32_t i = 0; i < tracking.guess.landmarks.size(); ++i) {
    const LandmarkId id = tracking.guess.landmarks[i];
    if (id == kNoLandmark) continue;
    matched.push_back(id);
    const double doubt = 2 * static_cast<double>(frame.features[i].static_probability) - 1;  // -1: surely dynamic
    evidence.push_back({id, config.found * doubt});
  }
  for (const Association& rejected : tracking.rejected) {
    matched.push_back(rejected.landmark);
    if (neighbours_fit(frame, tracking, rejected)) evidence.push_back({rejected.landmark, -config.rejected});
  }
  std::sort(matched.begin(), matched.end());
  const Eigen::Isometry3d T_camera_world = tracking.guess.T_world_camera.inverse();
  for (const LandmarkId id : tracking.visible) {
    const LocalLandmark* landmark =
        std::binary_search(matched.begin(), matched.end(), id) ? nullptr : map.find_landmark(id);
    const auto projection = landmark == nullptr ? std::nullopt : project(frame, T_camera_world, landmark->position);
    if (!projection) continue;
    if (removed_by_filter(frame, *landmark, *projection)) {
      evidence.push_back({id, -config.removed});
    } else if (seen_through(frame, *projection)) {
      evidence.push_back({id, -config.seen_through});
    }
  }
  return evidence;
}

}  // namespace rtd::slam
