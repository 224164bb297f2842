// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/floor_plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/geometry/se3.hpp"

namespace rtd::slam {
namespace {

using Eigen::Vector3d;

constexpr double kRadPerDeg = std::numbers::pi / 180;
const Vector3d kLevelUp(0, -1, 0);  // of a camera that looks horizontally

/// Points as a camera 1.2 m above the floor sees them; all of it is turned by `tilt_rad` (pitch, 0, roll).
class Room {
 public:
  Room(const Vector3d& tilt_rad, double depth_noise) : turn_(geometry::so3_exp(tilt_rad)), depth_noise_(depth_noise) {}

  Room& floor(int points, double nearest_m = 1.5) {
    for (int i = 0; i < points; ++i) add({between(-1.2, 1.2), kHeight_m, between(nearest_m, 4)});
    return *this;
  }
  Room& wall(int points, double distance_m = 4) {
    for (int i = 0; i < points; ++i) add({between(-2, 2), between(-1, kHeight_m), distance_m});
    return *this;
  }
  /// On a table 0.7 m high.
  Room& table(int points) {
    for (int i = 0; i < points; ++i) add({between(-0.5, 0.5), 0.5, between(1.2, 2.0)});
    return *this;
  }
  Room& clutter(int points) {
    for (int i = 0; i < points; ++i) add({between(-1.5, 1.5), between(-0.8, kHeight_m), between(1, 4)});
    return *this;
  }

  Vector3d up() const { return turn_ * kLevelUp; }
  const std::vector<Vector3d>& points() const { return points_; }

  static constexpr double kHeight_m = 1.2;

 private:
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  void add(const Vector3d& level) {
    const Vector3d p = turn_ * level;
    const double sigma_m = depth_noise_ * p.z() * p.z();
    const double z = p.z() + std::normal_distribution<double>(0, 1)(random_) * sigma_m;
    points_.push_back(p * (z / p.z()));
  }

  Eigen::Matrix3d turn_;
  double depth_noise_;
  std::mt19937_64 random_{5};
  std::vector<Vector3d> points_;
};

double error_deg(const FloorPlane& floor, const Room& room) {
  return std::acos(std::min(1.0, floor.up_camera.dot(room.up()))) / kRadPerDeg;
}

TEST(FloorPlane, of_an_exact_floor_is_exact) {
  const Room room = Room({0.3, 0, -0.2}, 0).floor(200);
  const auto floor = find_floor(room.points(), kLevelUp);
  ASSERT_TRUE(floor);
  EXPECT_LT(error_deg(*floor, room), 1e-4);
  EXPECT_NEAR(floor->height_m, Room::kHeight_m, 1e-6);
  EXPECT_EQ(floor->points, 200);
}

TEST(FloorPlane, is_found_to_a_degree_in_noise_and_clutter) {
  for (const Vector3d& tilt_rad : {Vector3d(0, 0, 0), Vector3d(0.5, 0, 0), Vector3d(-0.2, 0, 0.4)}) {
    const Room room = Room(tilt_rad, 0.003).floor(120).wall(300).clutter(400);
    const auto floor = find_floor(room.points(), kLevelUp);
    ASSERT_TRUE(floor) << tilt_rad.transpose();
    EXPECT_LT(error_deg(*floor, room), 1) << tilt_rad.transpose();
    EXPECT_LT(error_deg(*floor, room), 3 * floor->sigma_rad / kRadPerDeg + 0.2) << "says how well it is known";
    EXPECT_NEAR(floor->height_m, Room::kHeight_m, 0.05);
  }
}

TEST(FloorPlane, is_what_lies_below_the_table) {
  const Room room = Room({0.35, 0, 0}, 0.002).table(300).floor(120).clutter(100);
  const auto floor = find_floor(room.points(), kLevelUp);
  ASSERT_TRUE(floor);
  EXPECT_NEAR(floor->height_m, Room::kHeight_m, 0.05) << "not the table, which has more points";
}

TEST(FloorPlane, of_a_table_alone_is_as_level) {
  const Room room = Room({0.5, 0, 0}, 0.001).table(300);
  const auto floor = find_floor(room.points(), kLevelUp);
  ASSERT_TRUE(floor);
  EXPECT_LT(error_deg(*floor, room), 1);
}

TEST(FloorPlane, is_no_wall_and_not_found_without_a_floor) {
  EXPECT_FALSE(find_floor(Room({0, 0, 0}, 0.002).wall(800).points(), kLevelUp));
  EXPECT_FALSE(find_floor(Room({0.4, 0, 0}, 0.002).wall(800).points(), kLevelUp)) << "a wall, looked down at";
  EXPECT_FALSE(find_floor(Room({0, 0, 0}, 0.002).clutter(800).points(), kLevelUp));
  EXPECT_FALSE(find_floor(Room({0, 0, 0}, 0.002).wall(500).floor(20).points(), kLevelUp)) << "too little of it";
  EXPECT_FALSE(find_floor({}, kLevelUp));
  EXPECT_FALSE(find_floor(std::vector<Vector3d>(500, Vector3d(0, 1, 2)), kLevelUp)) << "one place";
}

/// Books and cables on a desk, higher on one side: a plane through them slants.
std::vector<Vector3d> full_desk(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const double highest_m = between(0.03, 0.12), bare = between(0.05, 0.3), slant = between(0, 1);
  std::vector<Vector3d> points;
  for (int i = 0; i < 600; ++i) {
    const double x = between(-0.6, 0.6), z = between(0.8, 1.8);
    const double heap_m = highest_m * (1 - slant + slant * (z - 0.8));
    points.emplace_back(x, 0.8 - (between(0, 1) < bare ? 0 : between(0, heap_m)), z);
  }
  return points;
}

TEST(FloorPlane, through_the_things_on_a_desk_is_refused_or_says_how_wrong_it_is) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto floor = find_floor(full_desk(seed), kLevelUp);
    if (!floor) continue;
    EXPECT_LT(std::acos(std::min(1.0, floor->up_camera.dot(kLevelUp))), 3 * floor->sigma_rad) << seed;
  }
}

TEST(FloorPlane, is_not_believed_with_things_under_it) {
  const Room room = Room({0.5, 0, 0}, 0.001).table(300).floor(35);
  EXPECT_FALSE(find_floor(room.points(), kLevelUp)) << "the floor has too few points, the table is not the lowest";
}

TEST(FloorPlane, knows_its_direction_no_better_than_the_camera_is_calibrated) {
  const Room room = Room({0.3, 0, -0.2}, 0).floor(200);
  EXPECT_GE(find_floor(room.points(), kLevelUp, 0.01)->sigma_rad, 0.01);
}

TEST(FloorPlane, is_not_found_where_up_is_given_far_off) {
  const Room room = Room({50 * kRadPerDeg, 0, 0}, 0.002).floor(300);
  EXPECT_FALSE(find_floor(room.points(), kLevelUp)) << "50 degrees";
  EXPECT_TRUE(find_floor(room.points(), room.up()));
}

TEST(FloorPlane, is_not_believed_where_a_narrow_strip_shows_it) {
  std::vector<Vector3d> strip;
  for (int i = 0; i < 200; ++i) strip.emplace_back(0.0005 * i, 1.2, 2 + 0.01 * i);
  EXPECT_FALSE(find_floor(strip, kLevelUp));
}

}  // namespace
}  // namespace rtd::slam
