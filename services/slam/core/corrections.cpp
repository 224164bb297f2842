// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/corrections.hpp"

#include <iterator>

namespace rtd::slam {

std::vector<PoseCorrection> OdometryStretch::spread(const Eigen::Isometry3d& T_world_expected,
                                                    const Eigen::Isometry3d& T_world_found) const {
  const Eigen::Vector3d error_m = T_world_found.translation() - T_world_expected.translation();
  const Eigen::AngleAxisd turn(T_world_found.linear() * T_world_expected.linear().transpose());
  std::vector<PoseCorrection> corrections;
  corrections.reserve(frames_.size());
  for (const auto& [seq, T_world_camera] : frames_) {
    const double share = static_cast<double>(corrections.size() + 1) / static_cast<double>(frames_.size() + 1);
    Eigen::Isometry3d T_world_smoothed = T_world_camera;
    T_world_smoothed.translation() += share * error_m;
    T_world_smoothed.linear() = Eigen::AngleAxisd(share * turn.angle(), turn.axis()) * T_world_camera.linear();
    corrections.push_back({seq, T_world_camera.inverse() * T_world_smoothed});
  }
  return corrections;
}

void KeyframeChangeQueue::add(const std::vector<KeyframeChange>& changes) {
  for (const KeyframeChange& change : changes) {
    if (change.kind == KeyframeChange::Kind::kCorrected) {
      corrected_[change.id] = change;
    } else {
      corrected_.erase(change.id);
      in_order_.push_back(change);
    }
  }
}

std::vector<KeyframeChange> KeyframeChangeQueue::take(std::size_t count) {
  std::vector<KeyframeChange> changes;
  while (changes.size() < count && !in_order_.empty()) {
    changes.push_back(in_order_.front());
    in_order_.pop_front();
  }
  while (changes.size() < count && !corrected_.empty()) {
    const auto newest = std::prev(corrected_.end());
    changes.push_back(newest->second);
    corrected_.erase(newest);
  }
  return changes;
}

}  // namespace rtd::slam
