// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/core/voxel_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

namespace rtd::dense {
namespace {

const Eigen::Vector3f kAhead = Eigen::Vector3f::UnitZ();

Sample sample(const Eigen::Vector3f& p_world, float gate_m = 0, float weight = 1) {
  return {p_world, kAhead, gate_m, weight, {10, 20, 30}};
}

TEST(VoxelMap, keeps_the_weighted_mean_of_a_cell) {
  VoxelMap map({});
  ASSERT_TRUE(map.add(sample({0.001F, 0.001F, 1.001F}, 0, 1), 1, 0));
  ASSERT_TRUE(map.add({{0.005F, 0.001F, 1.001F}, kAhead, 0, 3, {50, 20, 30}}, 2, 0));
  ASSERT_EQ(map.voxels().size(), 1U);
  const Voxel& voxel = map.voxels()[0];
  EXPECT_NEAR(voxel.p_world.x(), 0.004, 1e-6) << "m";
  EXPECT_NEAR(voxel.bgr[0], 40, 1e-4);
  EXPECT_FLOAT_EQ(voxel.weight, 4);
  EXPECT_EQ(voxel.sightings, 2);
}

TEST(VoxelMap, counts_a_frame_once) {
  VoxelMap map({});
  for (int i = 0; i < 5; ++i) map.add(sample({0, 0, 1}), 7, 0);
  EXPECT_EQ(map.voxels()[0].sightings, 1);
  EXPECT_EQ(map.voxels()[0].evidence, 1);
}

TEST(VoxelMap, joins_the_surface_along_the_ray_but_nothing_behind_the_gate) {
  VoxelMap map({});
  map.add(sample({0.001F, 0.001F, 1.001F}, 0, 10), 1, 0);
  map.add(sample({0.001F, 0.001F, 1.031F}, 0.04F), 2, 0);
  EXPECT_EQ(map.voxels().size(), 1U) << "3 cm behind, the gate is 4 cm";
  map.add(sample({0.001F, 0.001F, 1.051F}, 0.04F), 3, 0);
  EXPECT_EQ(map.voxels().size(), 2U) << "5 cm behind";
}

TEST(VoxelMap, refuses_new_voxels_when_full_and_refines_known_ones) {
  VoxelMap map({.max_voxels = 10});
  for (int i = 0; i < 30; ++i) {
    EXPECT_EQ(map.add(sample({0.1F * static_cast<float>(i), 0, 1}), 1, 0), i < 10) << i;
  }
  EXPECT_TRUE(map.full());
  EXPECT_TRUE(map.add(sample({0, 0, 1}), 2, 0));
  EXPECT_EQ(map.voxels().size(), 10U);
}

TEST(VoxelMap, refuses_points_that_are_not_finite_or_out_of_bounds) {
  VoxelMap map({});
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  for (const Eigen::Vector3f& p :
       {Eigen::Vector3f(kNan, 0, 0), Eigen::Vector3f(0, kInf, 0), Eigen::Vector3f(0, 0, 1e9F)}) {
    EXPECT_FALSE(map.add(sample(p), 1, 0));
    EXPECT_EQ(map.at(p), nullptr);
  }
}

TEST(VoxelMap, finds_every_voxel_after_some_were_taken_away) {
  VoxelMap map({});
  for (int i = 0; i < 100; ++i) map.add(sample({0.1F * static_cast<float>(i), 0, 1}), 1, static_cast<AnchorId>(i % 2));
  EXPECT_EQ(map.remove_if([](Voxel& voxel) { return voxel.anchor == 1; }), 50U);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(map.at({0.1F * static_cast<float>(i), 0, 1}) != nullptr, i % 2 == 0) << i;
  }
}

TEST(VoxelMap, moves_the_points_of_an_anchor_and_merges_those_that_meet) {
  VoxelMap map({});
  map.add(sample({0.005F, 0, 1.005F}, 0, 1), 1, 0);
  map.add(sample({0.505F, 0, 1.005F}, 0, 3), 2, 1);
  map.add(sample({1.005F, 0, 1.005F}, 0, 1), 3, 2);
  Eigen::Isometry3f left = Eigen::Isometry3f::Identity();
  left.translation().x() = -0.5F;
  const std::map<AnchorId, Eigen::Isometry3f> motions{{1, left}, {2, left}};
  map.move([&](AnchorId anchor) {
    const auto found = motions.find(anchor);
    return found == motions.end() ? nullptr : &found->second;
  });
  ASSERT_EQ(map.voxels().size(), 2U) << "the second joined the first; the third took the second's place untouched";
  ASSERT_NE(map.at({0.005F, 0, 1.005F}), nullptr);
  EXPECT_FLOAT_EQ(map.at({0.005F, 0, 1.005F})->weight, 4);
  ASSERT_NE(map.at({0.505F, 0, 1.005F}), nullptr);
  EXPECT_EQ(map.at({0.505F, 0, 1.005F})->anchor, 2U);
  EXPECT_EQ(map.at({1.005F, 0, 1.005F}), nullptr);
}

}  // namespace
}  // namespace rtd::dense
