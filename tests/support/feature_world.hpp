// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
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
  /// With noise as of a real camera: half a pixel, depth as of a Kinect, 12 flipped bits.
  static FeatureWorld noisy(std::uint64_t seed = 1);

  /// The features seen from a pose; seq and a stamp of 30 Hz. Same arguments, same frame.
  std::unique_ptr<msg::FeatureFrame> view(std::uint64_t seq, const Eigen::Isometry3d& T_world_camera) const;
  std::unique_ptr<msg::FeatureFrame> view(std::uint64_t seq) const { return view(seq, T_world_camera(seq)); }
  /// The features of a camera on the hand-held path whose rows are read out one after the other; the stamp is that of
  /// the middle row.
  std::unique_ptr<msg::FeatureFrame> rolling_view(std::uint64_t seq, double readout_s) const;
  /// A smooth hand-held motion, identity at seq 0: about 0.6 m and 25 degrees to and fro.
  static Eigen::Isometry3d T_world_camera(std::uint64_t seq);
  static Eigen::Isometry3d T_world_camera_at(double time_s);  ///< the same path, seconds after seq 0
  static constexpr std::int64_t stamp_ns(std::uint64_t seq) {
    return 1'000'000'000 + static_cast<std::int64_t>(seq) * 33'333'333;
  }

  static constexpr double kFx = 520, kFy = 521, kCx = 319.5, kCy = 239.5;
  static constexpr std::uint32_t kWidth = 640, kHeight = 480;

 private:
  /// T_camera_world while the row is exposed that lies `share` of the image's height below the middle.
  using RowPose = std::function<Eigen::Isometry3d(double share)>;
  std::unique_ptr<msg::FeatureFrame> view(std::uint64_t seq, const RowPose& T_camera_world, double roll_rad) const;

  struct Point {
    Eigen::Vector3d p_world;
    double max_distance_m;  ///< octave 0 shows it at this distance
    msg::Descriptor descriptor;
    float angle_rad;
  };
  Options options_;
  std::vector<Point> points_;
};

/// For tests in which no time passes.
inline std::int64_t frozen_clock() {
  return 0;
}

/// A frame of FeatureWorld's camera without features yet.
std::unique_ptr<msg::FeatureFrame> make_empty_view(std::uint64_t seq);

/// A feature as a view shows it.
struct SeenFeature {
  double u_px, v_px, depth_m;
  float angle_rad;
  int octave;  ///< below 0: 0
};
/// Adds a feature; `flipped_bits` of the descriptor, drawn from `random`, are not what they should be.
void add_feature(msg::FeatureFrame& frame, const SeenFeature& seen, const msg::Descriptor& descriptor, int flipped_bits,
                 std::mt19937_64& random);

}  // namespace rtd::test_support
