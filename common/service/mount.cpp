// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/mount.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "common/io/printable.hpp"
#include "common/service/config.hpp"

namespace rtd::service {
namespace {

constexpr double kUnitTolerance = 0.01;  // of a quaternion written with few digits
constexpr double kFarthestMount_m = 100;

}  // namespace

Eigen::Isometry3d parse_mount(const std::string& text, const std::string& key) {
  std::array<double, 7> values{};
  std::istringstream words(text);
  bool complete = std::ranges::count(text, ',') == static_cast<std::ptrdiff_t>(values.size()) - 1;
  for (double& value : values) {
    std::string word;
    std::getline(words, word, ',');
    char* end = nullptr;
    value = std::strtod(word.c_str(), &end);
    complete = complete && !word.empty() && *end == '\0' && std::isfinite(value);
  }
  const Eigen::Quaterniond q(values[6], values[3], values[4], values[5]);
  const Eigen::Vector3d t(values[0], values[1], values[2]);
  if (!complete || std::abs(q.norm() - 1) > kUnitTolerance || t.norm() > kFarthestMount_m) {
    const bool of_camera = key == "slam.base.camera";
    if (!of_camera) {
      throw ConfigError(key + "=" + io::abridged(text) +
                        ": must be x,y,z,qx,qy,qz,qw: where the IMU is, m, and how its axes are turned, a "
                        "quaternion of length 1. In the optical frame itself: 0,0,0,0,0,0,1");
    }
    throw ConfigError(
        "slam.base.camera=" + io::abridged(text) +
        ": must be x,y,z,qx,qy,qz,qw: where the camera is in the base, m, and how its optical frame (x right, y down, "
        "z forward) is turned, a quaternion of length 1. A camera 0.4 m above the base that looks forward: "
        "0,0,0.4,-0.5,0.5,-0.5,0.5");
  }
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = t;
  T.linear() = q.normalized().toRotationMatrix();
  return T;
}

}  // namespace rtd::service
