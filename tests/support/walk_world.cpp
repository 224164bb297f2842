// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/walk_world.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/feature_world.hpp"

namespace rtd::test_support {
namespace {

constexpr double kHalfHeight_m = 1.5;
constexpr double kMinDistance_m = 0.4;
constexpr int kMaxOctave = 7;
constexpr std::size_t kMaxCells = 2000;  // more than any view needs

Eigen::Isometry3d upright_pose(double x_m, double z_m, double yaw_rad, double pitch_rad) {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  T_world_camera.translation() = Eigen::Vector3d(x_m, 0, z_m);
  T_world_camera.linear() =
      (Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  return T_world_camera;
}

double seconds(std::uint64_t seq) {
  return static_cast<double>(seq) / 30.0;
}

std::uint64_t cell_key(int x, int z) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32U) | static_cast<std::uint32_t>(z);
}

}  // namespace

const WalkWorld::Cell& WalkWorld::cell(int x, int z) {
  const auto [found, added] = cells_.try_emplace(cell_key(x, z));
  if (added) found->second = make_cell(x, z);
  return found->second;
}

WalkWorld::Cell WalkWorld::make_cell(int x, int z) const {
  std::mt19937_64 random(options_.seed * 0x9E3779B97F4A7C15U ^ (cell_key(x, z) + 1) * 0xBF58476D1CE4E5B9U);
  std::uniform_real_distribution<double> unit(0, 1);
  Cell cell(static_cast<std::size_t>(options_.points_per_m3 * 2 * kHalfHeight_m));
  for (Point& point : cell) {
    point.p_world = {x + unit(random), kHalfHeight_m * (2 * unit(random) - 1), z + unit(random)};
    point.max_distance_m = 2 * std::pow(options_.range_m, unit(random));
    for (std::uint8_t& byte : point.descriptor) byte = static_cast<std::uint8_t>(random());
    point.angle_rad = static_cast<float>(2 * std::numbers::pi * unit(random));
  }
  return cell;
}

std::unique_ptr<msg::FeatureFrame> WalkWorld::view(std::uint64_t seq, const Eigen::Isometry3d& T_world_camera) {
  if (cells_.size() > kMaxCells) cells_.clear();
  auto frame = make_empty_view(seq);
  std::mt19937_64 random(options_.seed * 7919 + seq);
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  const Eigen::Vector3d centre = T_world_camera.translation(), axis = T_world_camera.linear().col(2);
  const int reach = static_cast<int>(std::ceil(options_.range_m));
  for (int dx = -reach; dx <= reach; ++dx) {
    for (int dz = -reach; dz <= reach; ++dz) {
      const int x = static_cast<int>(std::floor(centre.x())) + dx, z = static_cast<int>(std::floor(centre.z())) + dz;
      const Eigen::Vector3d offset = Eigen::Vector3d(x + 0.5, 0, z + 0.5) - centre;
      const double along_m = offset.dot(axis), across_m = (offset - along_m * axis).norm();
      const bool in_wedge = along_m >= -1 && across_m <= 0.65 * std::max(along_m, 0.0) + 1.5;
      if (!in_wedge) continue;
      for (const Point& point : cell(x, z)) observe(point, T_camera_world, *frame, random);
    }
  }
  return frame;
}

void WalkWorld::observe(const Point& point, const Eigen::Isometry3d& T_camera_world, msg::FeatureFrame& frame,
                        std::mt19937_64& random) const {
  std::normal_distribution<double> normal(0, 1);
  std::uniform_real_distribution<double> unit(0, 1);
  const Eigen::Vector3d p_camera = T_camera_world * point.p_world;
  const double distance_m = p_camera.norm();
  if (p_camera.z() < kMinDistance_m || distance_m > std::min(options_.range_m, point.max_distance_m)) return;
  const int octave = static_cast<int>(std::ceil(std::log(point.max_distance_m / distance_m) / std::log(1.2)));
  const double sigma_px = options_.noise_px * std::pow(1.2, octave);
  const double u = FeatureWorld::kFx * p_camera.x() / p_camera.z() + FeatureWorld::kCx + sigma_px * normal(random);
  const double v = FeatureWorld::kFy * p_camera.y() / p_camera.z() + FeatureWorld::kCy + sigma_px * normal(random);
  if (u < 0 || v < 0 || u >= FeatureWorld::kWidth || v >= FeatureWorld::kHeight || octave > kMaxOctave) return;
  if (unit(random) > options_.detection_rate || frame.count == msg::kMaxFeatures) return;
  const double noise_m = options_.depth_noise_factor * p_camera.z() * p_camera.z() * normal(random);
  add_feature(frame, {u, v, p_camera.z() + noise_m, point.angle_rad, octave}, point.descriptor, options_.flipped_bits,
              random);
}

Eigen::Isometry3d aisle_pose(std::uint64_t seq) {
  constexpr double kAisle_m = 60, kTurnRadius_m = 6, kSpeed_m_s = 1.5, kTurn_m = std::numbers::pi * kTurnRadius_m;
  const double t = seconds(seq), walked_m = kSpeed_m_s * t;
  const auto lap = static_cast<std::uint64_t>(walked_m / (kAisle_m + kTurn_m));
  const double in_lap_m = walked_m - static_cast<double>(lap) * (kAisle_m + kTurn_m);
  const bool up = lap % 2 == 0;
  const double turn_rad = std::max(0.0, in_lap_m - kAisle_m) / kTurnRadius_m;
  // The turn at the end leads into the next aisle, 2 radii to the right of this one.
  const double along_m = std::min(in_lap_m, kAisle_m) + kTurnRadius_m * std::sin(turn_rad);
  const double x_m = 2 * kTurnRadius_m * static_cast<double>(lap) + kTurnRadius_m * (1 - std::cos(turn_rad));
  const double heading_rad = up ? turn_rad : std::numbers::pi - turn_rad;
  return upright_pose(x_m, up ? along_m : kAisle_m - along_m, heading_rad + 0.1 * std::sin(1.3 * t),
                      0.05 * std::sin(1.9 * t));
}

Eigen::Isometry3d room_pose(std::uint64_t seq) {
  const double t = seconds(seq);
  return upright_pose(1.5 * std::sin(0.31 * t), 1.5 * (1 - std::cos(0.23 * t)), 0.37 * t, 0.2 * std::sin(0.7 * t));
}

}  // namespace rtd::test_support
