// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "common/msg/features.hpp"

namespace rtd::test_support {

/// A static world of points with unmistakable descriptors, seen as feature frames without any image: known poses, known
/// correspondences, adjustable noise. World axes are those of the first camera (x right, y down, z forward).
class FeatureWorld {
 public:
  struct Options {
    int points = 1500;
    double min_depth_m = 1.2, max_depth_m = 4.5;  ///< of the points, along the world's z
    double noise_px = 0.0;
    double depth_noise_factor = 0.0;  ///< sigma = factor * z^2, m
    int flipped_bits = 0;             ///< of each descriptor, at random in each view
    std::uint64_t seed = 1;
  };
  explicit FeatureWorld(const Options& options);

  /// The features seen from a pose; seq and a stamp of 30 Hz. Same arguments, same frame.
  std::unique_ptr<msg::FeatureFrame> view(std::uint64_t seq, const Eigen::Isometry3d& T_world_camera) const;
  /// A smooth hand-held motion, identity at seq 0: about 0.6 m and 25 degrees to and fro.
  static Eigen::Isometry3d T_world_camera(std::uint64_t seq);
  static constexpr std::int64_t stamp_ns(std::uint64_t seq) {
    return 1'000'000'000 + static_cast<std::int64_t>(seq) * 33'333'333;
  }

  static constexpr double kFx = 520, kFy = 521, kCx = 319.5, kCy = 239.5;
  static constexpr std::uint32_t kWidth = 640, kHeight = 480;

 private:
  struct Point {
    Eigen::Vector3d p_world;
    double max_distance_m;  ///< octave 0 shows it at this distance
    msg::Descriptor descriptor;
    float angle_rad;
  };
  Options options_;
  std::vector<Point> points_;
};

}  // namespace rtd::test_support
