// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

#include "services/evaluation/core/trajectory/trajectory_error.hpp"

namespace rtd::eval::testing_support {

/// A bent path with turning, `count` poses every `period_s` from 100 s on.
inline Trajectory winding_path(int count, double period_s) {
  Trajectory trajectory;
  for (int i = 0; i < count; ++i) {
    const double s = 0.1 * i;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() << std::sin(s), 0.5 * std::cos(1.7 * s), 0.1 * s;
    T.linear() = (Eigen::AngleAxisd(0.3 * s, Eigen::Vector3d::UnitY()) *
                  Eigen::AngleAxisd(0.2 * std::sin(s), Eigen::Vector3d::UnitX()))
                     .toRotationMatrix();
    trajectory.push_back({std::llround((100 + i * period_s) * 1e9), T});
  }
  return trajectory;
}

inline Eigen::Isometry3d some_transform() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  T.translation() << 3, -4, 5;
  return T;
}

/// The same motion seen from another world frame: T_other_body = T_other_world * T_world_body.
inline Trajectory moved(const Trajectory& trajectory, const Eigen::Isometry3d& T_other_world, double scale = 1) {
  Trajectory result = trajectory;
  for (StampedPose& pose : result) {
    pose.T_world_body.translation() *= scale;
    pose.T_world_body = T_other_world * pose.T_world_body;
  }
  return result;
}

/// The trajectory as a file in TUM format.
inline std::string tum_text(const Trajectory& trajectory) {
  std::string text = "# stamp tx ty tz qx qy qz qw\n";
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d t = pose.T_world_body.translation();
    const Eigen::Quaterniond q(pose.T_world_body.linear());
    char line[256];
    std::snprintf(line, sizeof line, "%lld.%09lld %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
                  static_cast<long long>(pose.stamp_ns / 1'000'000'000),
                  static_cast<long long>(pose.stamp_ns % 1'000'000'000), t.x(), t.y(), t.z(), q.x(), q.y(), q.z(),
                  q.w());
    text += line;
  }
  return text;
}

}  // namespace rtd::eval::testing_support
