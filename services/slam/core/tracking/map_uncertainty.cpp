// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/map_uncertainty.hpp"

#include <algorithm>

namespace rtd::slam {
namespace {

using geometry::Matrix6d;

/// What an error of the pose (translation, rotation about it) at `from` means at `to`. Eq. (14).
Matrix6d moved(const Matrix6d& covariance, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  Matrix6d lever = Matrix6d::Identity();
  lever.topRightCorner<3, 3>() = -geometry::skew(to - from);
  return lever * covariance * lever.transpose();
}

/// Index of the oldest keyframe of the window that sees the landmark.
std::uint32_t oldest_observer(const LocalMap& map, const LocalLandmark& landmark) {
  const auto first = map.observers.begin() + landmark.first_observer;
  return *std::min_element(first, first + landmark.observers,
                           [&](std::uint32_t a, std::uint32_t b) { return map.keyframes[a].id < map.keyframes[b].id; });
}

}  // namespace

Matrix6d MapUncertainty::in_world(const Matrix6d& local, const Eigen::Vector3d& position,
                                  const std::vector<LandmarkId>& landmarks, const LocalMap& map) {
  if (const auto inherited = of_landmarks(position, landmarks, map)) return local + *inherited;
  // A map that begins, or was loaded: its first keyframe is the world, by measurements that are no better than these.
  add_keyframe(map.keyframes.front().frame->seq, position, local);
  return 2 * local;
}

void MapUncertainty::add_keyframe(std::uint64_t frame_seq, const Eigen::Vector3d& position,
                                  const Matrix6d& covariance) {
  keyframes_[frame_seq] = {position, covariance};
}

std::optional<Matrix6d> MapUncertainty::of_landmarks(const Eigen::Vector3d& position,
                                                     const std::vector<LandmarkId>& landmarks,
                                                     const LocalMap& map) const {
  std::vector<int> seen(map.keyframes.size(), 0);
  for (const LandmarkId id : landmarks) {
    const LocalLandmark* landmark = id == kNoLandmark ? nullptr : map.find_landmark(id);
    if (landmark != nullptr && landmark->observers > 0) ++seen[oldest_observer(map, *landmark)];
  }
  Matrix6d sum = Matrix6d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto known = keyframes_.find(map.keyframes[i].frame->seq);
    if (seen[i] == 0 || known == keyframes_.end()) continue;
    sum += seen[i] * moved(known->second.covariance, known->second.position, position);
    count += seen[i];
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

}  // namespace rtd::slam
