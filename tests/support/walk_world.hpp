// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <random>
#include <unordered_map>
#include <vector>

#include "common/msg/features.hpp"

namespace rtd::test_support {

/// A world of points without end, made cell by cell where the camera looks: for maps of any size. Known poses, known
/// correspondences, about 1000 features a frame. World axes are those of the first camera (x right, y down, z forward).
class WalkWorld {
 public:
  struct Options {
    double points_per_m3 = 68;          ///< about 1000 features in view
    double range_m = 5.0;               ///< farther points are not seen
    double detection_rate = 0.7;        ///< of the points in view, each for itself in each frame
    double noise_px = 0.5;              ///< at the finest octave
    double depth_noise_factor = 0.002;  ///< sigma = factor * z^2, m
    int flipped_bits = 12;              ///< of each descriptor, at random in each view
    std::uint64_t seed = 1;
  };
  explicit WalkWorld(const Options& options) : options_(options) {}

  /// The features seen from a pose; seq and a stamp of 30 Hz. Same arguments, same frame.
  std::unique_ptr<msg::FeatureFrame> view(std::uint64_t seq, const Eigen::Isometry3d& T_world_camera);

 private:
  struct Point {
    Eigen::Vector3d p_world;
    double max_distance_m;  ///< octave 0 shows it at this distance
    msg::Descriptor descriptor;
    float angle_rad;
  };
  using Cell = std::vector<Point>;  ///< 1 m x 1 m of floor, 3 m high

  const Cell& cell(int x, int z);
  Cell make_cell(int x, int z) const;
  /// Adds the point to the frame if this view shows it.
  void observe(const Point& point, const Eigen::Isometry3d& T_camera_world, msg::FeatureFrame& frame,
               std::mt19937_64& random) const;

  Options options_;
  std::unordered_map<std::uint64_t, Cell> cells_;  ///< those looked at lately
};

/// Up and down long aisles, 1.5 m a second at 30 Hz, swaying a little: never twice at the same place.
Eigen::Isometry3d aisle_pose(std::uint64_t seq);
/// Round and round in a room of 4 m x 4 m, looking outwards and about: always the same places.
Eigen::Isometry3d room_pose(std::uint64_t seq);

}  // namespace rtd::test_support
