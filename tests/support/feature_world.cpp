// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/feature_world.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/se3.hpp"

namespace rtd::test_support {

FeatureWorld::FeatureWorld(const Options& options) : options_(options) {
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> side(-1.2, 1.2), depth(options.min_depth_m, options.max_depth_m), unit(0, 1);
  for (int i = 0; i < options.points; ++i) {
    Point point;
    const double z = depth(random);
    point.p_world = {side(random) * z, side(random) * z * 0.75, z};
    point.max_distance_m = z * std::pow(1.2, 4 * unit(random));
    for (std::uint8_t& byte : point.descriptor) byte = static_cast<std::uint8_t>(random());
    point.angle_rad = static_cast<float>(6.28 * unit(random));
    points_.push_back(point);
  }
}

FeatureWorld FeatureWorld::noisy(std::uint64_t seed) {
  Options options;
  options.noise_px = 0.5;
  options.depth_noise_factor = 0.0015;
  options.flipped_bits = 12;
  options.seed = seed;
  return FeatureWorld(options);
}

Eigen::Isometry3d FeatureWorld::T_world_camera(std::uint64_t seq) {
  return T_world_camera_at(static_cast<double>(seq) / 30.0);
}

Eigen::Isometry3d FeatureWorld::T_world_camera_at(double t) {
  geometry::Vector6d twist;
  twist << 0.6 * std::sin(1.5 * t), 0.3 * std::sin(1.1 * t), 0.3 * std::sin(0.9 * t), 0.2 * std::sin(1.3 * t),
      0.4 * std::sin(t), 0.2 * std::sin(0.8 * t);
  return geometry::se3_exp(twist);
}

std::unique_ptr<msg::FeatureFrame> FeatureWorld::view(std::uint64_t seq,
                                                      const Eigen::Isometry3d& T_world_camera) const {
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  return view(
      seq, [&](double) { return T_camera_world; }, geometry::so3_log(T_world_camera.linear()).z());
}

std::unique_ptr<msg::FeatureFrame> FeatureWorld::rolling_view(std::uint64_t seq, double readout_s) const {
  const double time_s = static_cast<double>(seq) / 30.0;
  const auto pose = [&](double share) { return T_world_camera_at(time_s + share * readout_s).inverse(); };
  return view(seq, pose, geometry::so3_log(T_world_camera(seq).linear()).z());
}

std::unique_ptr<msg::FeatureFrame> FeatureWorld::view(std::uint64_t seq, const RowPose& T_camera_world,
                                                      double roll_rad) const {
  auto frame = make_empty_view(seq);
  std::mt19937_64 random(options_.seed * 7919 + seq);
  std::normal_distribution<double> normal(0, 1);
  for (const Point& point : points_) {
    Eigen::Vector3d p_camera = T_camera_world(0) * point.p_world;
    for (int i = 0; i < 2 && p_camera.z() > 0.3; ++i) {  // the row decides on the pose, and the pose on the row
      p_camera = T_camera_world((kFy * p_camera.y() / p_camera.z() + kCy) / kHeight - 0.5) * point.p_world;
    }
    if (p_camera.z() < 0.3 || frame->count == msg::kMaxFeatures) continue;
    const int octave = static_cast<int>(std::ceil(std::log(point.max_distance_m / p_camera.norm()) / std::log(1.2)));
    const double u = kFx * p_camera.x() / p_camera.z() + kCx + options_.noise_px * normal(random);
    const double v = kFy * p_camera.y() / p_camera.z() + kCy + options_.noise_px * normal(random);
    if (u < 0 || v < 0 || u >= kWidth || v >= kHeight || octave > 7) continue;
    const double noise_m = options_.depth_noise_factor * p_camera.z() * p_camera.z() * normal(random);
    add_feature(*frame, {u, v, p_camera.z() + noise_m, point.angle_rad - static_cast<float>(roll_rad), octave},
                point.descriptor, options_.flipped_bits, random);
  }
  return frame;
}

std::unique_ptr<msg::FeatureFrame> make_empty_view(std::uint64_t seq) {
  auto frame = std::make_unique<msg::FeatureFrame>();
  frame->seq = seq;
  frame->stamp_ns = FeatureWorld::stamp_ns(seq);
  frame->intrinsics = {FeatureWorld::kFx, FeatureWorld::kFy, FeatureWorld::kCx, FeatureWorld::kCy};
  frame->width = FeatureWorld::kWidth;
  frame->height = FeatureWorld::kHeight;
  return frame;
}

void add_feature(msg::FeatureFrame& frame, const SeenFeature& seen, const msg::Descriptor& descriptor, int flipped_bits,
                 std::mt19937_64& random) {
  msg::Feature& feature = frame.features[frame.count++];
  feature = {};
  feature.u_px = feature.u_raw_px = static_cast<float>(seen.u_px);
  feature.v_px = feature.v_raw_px = static_cast<float>(seen.v_px);
  feature.depth_m = static_cast<float>(seen.depth_m);
  feature.angle_rad = seen.angle_rad;
  feature.static_probability = 1;
  feature.octave = static_cast<std::uint8_t>(std::max(seen.octave, 0));
  feature.object_id = -1;
  feature.descriptor = descriptor;
  for (int i = 0; i < flipped_bits; ++i) {
    const std::uint64_t bit = random() % 256;
    feature.descriptor[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
  }
}

}  // namespace rtd::test_support
