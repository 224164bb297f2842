// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/movers/world_movers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace rtd::filter {
namespace {

using Eigen::Vector3d;

constexpr std::int64_t kStepNs = 33'333'333;
constexpr double kHalfWidthM = 0.22, kHalfDepthM = 0.13;  // of a body

/// The front of an upright body as a camera at the origin sees it that looks along z, x to the right, y down.
ObjectSighting sight_body(const Vector3d& middle, std::uint32_t source, double visible_from = -1,
                          std::uint8_t tint = 0) {
  ObjectSighting sighting{.source = source, .class_name = "person", .score = 0.9};
  for (int row = 0; row < 12; ++row) {
    for (double across = -0.95; across < 1; across += 0.1) {
      if (across < visible_from) continue;
      const Vector3d from_middle(kHalfWidthM * across, -0.8 + 0.14 * row,
                                 -kHalfDepthM * std::sqrt(1 - across * across));
      sighting.points.push_back({middle + from_middle, tint});
    }
  }
  sighting.moving = sighting.points;
  sighting.cut_left = visible_from > -1;
  return sighting;
}

class WorldMoversTest : public ::testing::Test {
 protected:
  std::vector<WorldMover> step(const std::vector<ObjectSighting>& sightings) {
    now_ns_ += kStepNs;
    return movers_.place(now_ns_, Eigen::Isometry3d::Identity(), sightings);
  }
  double time_s() const { return 1e-9 * static_cast<double>(now_ns_ + kStepNs); }  ///< of the next step

  WorldMovers movers_;
  std::int64_t now_ns_ = 0;
};

double apart_m(const WorldMover& mover, const Vector3d& middle) {
  const Vector3d error = mover.extent_world.center() - middle;
  return std::hypot(error.x(), error.z());  // no frame shows the feet here
}

TEST_F(WorldMoversTest, are_where_they_are_and_as_fast) {
  const Vector3d velocity(0.6, 0, 0.2);
  for (int i = 0; i < 60; ++i) {
    const Vector3d middle = Vector3d(-1, 0, 2.5) + time_s() * velocity;
    const auto movers = step({sight_body(middle, 4)});
    ASSERT_EQ(movers.size(), 1U);
    if (i < 20) continue;
    EXPECT_LT(apart_m(movers[0], middle), 0.05) << "m";
    EXPECT_LT((movers[0].velocity_world_m_s - velocity).norm(), 0.08) << "m/s";
    EXPECT_NEAR(movers[0].extent_world.sizes().x(), 2 * kHalfWidthM, 0.08);
    EXPECT_EQ(movers[0].unseen_s, 0);
  }
}

TEST_F(WorldMoversTest, keep_their_number_while_they_are_hidden_for_a_second) {
  const Vector3d velocity(0.8, 0, 0);
  std::uint32_t id = 0;
  for (int i = 0; i < 90; ++i) {
    const Vector3d middle = Vector3d(-1.2, 0, 2.5) + time_s() * velocity;
    const bool hidden = i >= 40 && i < 68;
    const auto movers =
        step(hidden ? std::vector<ObjectSighting>{} : std::vector{sight_body(middle, i < 40 ? 1U : 2U)});
    ASSERT_EQ(movers.size(), 1U) << "frame " << i;
    if (i == 0) id = movers[0].id;
    EXPECT_EQ(movers[0].id, id) << "frame " << i;
    EXPECT_EQ(movers[0].unseen_s > 0, hidden) << "frame " << i;
    EXPECT_LT(movers[0].score, hidden ? 0.9 : 0.91);
    if (i > 20) {
      EXPECT_LT(apart_m(movers[0], middle), 0.15) << "frame " << i;
    }
    if (i == 67) {
      EXPECT_GT(movers[0].covariance(0, 0), 0.1) << "m^2: it may have turned";
    }
  }
}

TEST_F(WorldMoversTest, continue_on_a_surface_without_a_source_which_begins_nothing) {
  const auto sourceless = [this] {
    ObjectSighting sighting = sight_body({0.3 * time_s(), 0, 2}, 1);
    sighting.source.reset();
    return sighting;
  };
  EXPECT_TRUE(step({sourceless()}).empty());
  const std::uint32_t id = step({sight_body({0.3 * time_s(), 0, 2}, 1)}).at(0).id;
  for (int i = 0; i < 45; ++i) {
    const auto movers = step({sourceless()});
    ASSERT_EQ(movers.size(), 1U) << "frame " << i;
    EXPECT_EQ(movers[0].id, id);
    EXPECT_EQ(movers[0].unseen_s, 0);
  }
}

TEST_F(WorldMoversTest, that_were_hidden_for_longer_or_seen_but_once_are_others) {
  const Vector3d middle(0, 0, 2);
  const std::uint32_t first = step({sight_body(middle, 1)}).at(0).id;
  EXPECT_TRUE(step({}).empty()) << "seen once";
  EXPECT_NE(step({sight_body(middle, 1)}).at(0).id, first);
  for (int i = 0; i < 60; ++i) step({sight_body(middle, 1)});
  const std::uint32_t id = step({sight_body(middle, 1)}).at(0).id;
  for (int i = 0; i < 35; ++i) step({});
  EXPECT_TRUE(step({}).empty());
  EXPECT_NE(step({sight_body(middle, 1)}).at(0).id, id);
}

TEST_F(WorldMoversTest, that_pass_each_other_are_not_swapped) {
  std::uint32_t near = 0, far = 0;
  for (int i = 0; i < 90; ++i) {
    const Vector3d of_near(-1.2 + 0.8 * time_s(), 0, 1.8), of_far(1.2 - 0.8 * time_s(), 0, 2.9);
    const bool covered = std::abs(of_near.x() / of_near.z() - of_far.x() / of_far.z()) < 0.2;
    std::vector<ObjectSighting> sightings{sight_body(of_near, 1)};
    if (!covered) sightings.push_back(sight_body(of_far, i < 45 ? 2 : 3));
    const auto movers = step(sightings);
    ASSERT_EQ(movers.size(), 2U) << "frame " << i;
    const bool in_order = movers[0].extent_world.center().z() < movers[1].extent_world.center().z();
    const std::uint32_t near_id = movers[in_order ? 0 : 1].id, far_id = movers[in_order ? 1 : 0].id;
    if (i == 0) {
      near = near_id;
      far = far_id;
    }
    EXPECT_EQ(near_id, near) << "frame " << i;
    EXPECT_EQ(far_id, far) << "frame " << i;
  }
}

/// The boxes overlap in the image: both show the surface of the nearer body, and the other one in the background.
TEST_F(WorldMoversTest, the_farther_of_two_whose_boxes_overlap_is_followed_in_its_box) {
  constexpr std::uint8_t kBlue = 9, kYellow = 3;
  std::uint32_t near = 0, far = 0;
  for (int i = 0; i < 90; ++i) {
    const Vector3d of_near(-0.6 + 0.4 * time_s(), 0, 1.8), of_far(0.6 - 0.4 * time_s(), 0, 2.7);
    ObjectSighting first = sight_body(of_near, 1, -1, kBlue), second = sight_body(of_far, 2, -1, kYellow);
    if (std::abs(of_near.x() / of_near.z() - of_far.x() / of_far.z()) < 0.2) {
      second.moving.insert(second.moving.end(), first.points.begin(), first.points.end());
      second.points = first.points;
    }
    const auto movers = step({first, second});
    ASSERT_EQ(movers.size(), 2U) << "frame " << i;
    const bool in_order = movers[0].extent_world.center().z() < movers[1].extent_world.center().z();
    const WorldMover &nearer = movers[in_order ? 0 : 1], &farther = movers[in_order ? 1 : 0];
    if (i == 0) {
      near = nearer.id;
      far = farther.id;
    }
    EXPECT_EQ(nearer.id, near) << "frame " << i;
    EXPECT_EQ(farther.id, far) << "frame " << i;
    EXPECT_EQ(farther.unseen_s, 0) << "frame " << i;
    EXPECT_LT(apart_m(farther, of_far), 0.15) << "frame " << i;
  }
}

TEST_F(WorldMoversTest, who_turned_while_hidden_is_known_by_the_colours) {
  constexpr std::uint8_t kBlue = 9, kYellow = 3;
  std::uint32_t id = 0;
  for (int i = 0; i < 45; ++i) id = step({sight_body({-1 + 0.8 * time_s(), 0, 2.5}, 1, -1, kBlue)}).at(0).id;
  const Vector3d turned_at(-1 + 0.8 * time_s(), 0, 2.5);
  for (int i = 0; i < 15; ++i) step({});
  const auto movers = step({sight_body(turned_at - Vector3d(0.5, 0, 0), 5, -1, kBlue),
                            sight_body(turned_at - Vector3d(0.5, 0, -1), 6, -1, kYellow)});
  ASSERT_EQ(movers.size(), 2U);
  EXPECT_EQ(movers[0].id, id);
  EXPECT_LT(apart_m(movers[0], turned_at - Vector3d(0.5, 0, 0)), 0.15) << "m: at once";
  EXPECT_NE(movers[1].id, id);
}

TEST_F(WorldMoversTest, a_body_that_leaves_the_image_bit_by_bit_continues) {
  const Vector3d velocity(-0.5, 0, 0);
  for (int i = 0; i < 60; ++i) {
    const Vector3d middle = Vector3d(0.3, 0, 2) + time_s() * velocity;
    const double visible_from = i < 40 ? -1 : -1 + 0.06 * (i - 40);
    const auto movers = step({sight_body(middle, 1, visible_from)});
    if (i < 40) continue;
    EXPECT_LT(apart_m(movers.at(0), middle), 0.1) << "frame " << i;
    EXPECT_LT((movers.at(0).velocity_world_m_s - velocity).norm(), 0.2) << "frame " << i;
  }
}

TEST_F(WorldMoversTest, who_turns_on_the_spot_is_as_thick_as_before_and_stays) {
  const Vector3d middle(0, 0, 2.5);
  for (int i = 0; i < 90; ++i) {
    ObjectSighting sighting = sight_body(middle, 4);
    const double narrower = i < 40 ? 1 : std::max(0.5, 1 - 0.05 * (i - 40));  // from the front, then from the side
    for (SeenPoint& point : sighting.points) point.p_camera_m.x() *= narrower;
    const auto movers = step({sighting});
    if (i < 20) continue;
    EXPECT_LT(apart_m(movers.at(0), middle), 0.06) << "m, frame " << i;
    EXPECT_LT(movers.at(0).velocity_world_m_s.norm(), 0.1) << "m/s, frame " << i;
  }
}

/// Normalised squared errors of a body that turns at random: about one for each number.
TEST_F(WorldMoversTest, know_how_well_they_know_it) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  double sum = 0;
  int count = 0;
  Vector3d middle(0, 0, 2.5), velocity(0.3, 0, 0);
  for (int i = 0; i < 3000; ++i) {
    velocity +=
        Vector3d{0.08 * normal(random) - 0.02 * middle.x(), 0, 0.08 * normal(random) - 0.02 * (middle.z() - 2.5)};
    velocity *= 0.98;
    middle += 1e-9 * kStepNs * velocity;
    const Vector3d off{0.03 * normal(random), 0, 0.05 * normal(random)};
    const auto movers = step({sight_body(middle + off, 1)});
    ASSERT_EQ(movers.size(), 1U);
    if (i < 30) continue;
    Eigen::Matrix<double, 6, 1> error;
    error << movers[0].extent_world.center() - middle, movers[0].velocity_world_m_s - velocity;
    for (const int axis : {0, 2, 3, 5}) {
      sum += error[axis] * error[axis] / movers[0].covariance(axis, axis);
      ++count;
    }
  }
  EXPECT_GT(sum / count, 0.2);
  EXPECT_LT(sum / count, 1.5);
}

/// The map that slam makes with a robot base or --gravity: z up, x forward.
TEST_F(WorldMoversTest, are_in_the_frame_of_slams_poses) {
  Eigen::Isometry3d T_map_camera(Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5));
  T_map_camera.translation() = Vector3d(0.2, 0, 0.5);
  const Vector3d velocity_camera(0.4, 0, -0.3);
  std::vector<WorldMover> movers;
  Vector3d middle_camera;
  for (int i = 0; i < 50; ++i) {
    middle_camera = Vector3d(-0.3, 0, 3) + time_s() * velocity_camera;
    now_ns_ += kStepNs;
    movers = movers_.place(now_ns_, T_map_camera, {sight_body(middle_camera, 1)});
    ASSERT_EQ(movers.size(), 1U);
  }
  const Vector3d expected = T_map_camera * middle_camera;
  EXPECT_NEAR(movers[0].extent_world.center().x(), expected.x(), 0.05);
  EXPECT_NEAR(movers[0].extent_world.center().y(), expected.y(), 0.05);
  EXPECT_TRUE(movers[0].velocity_world_m_s.isApprox(T_map_camera.linear() * velocity_camera, 0.15));
  EXPECT_GT(movers[0].extent_world.sizes().z(), 1.2) << "upright along z";
  EXPECT_GT(movers[0].covariance(0, 0), movers[0].covariance(1, 1)) << "less well known along the view, which is x";
}

TEST_F(WorldMoversTest, without_a_class_are_left_out_where_one_with_a_class_is) {
  ObjectSighting moving = sight_body({0, 0, 2}, 7);
  moving.class_name.clear();
  const auto movers = step({sight_body({0, 0, 2}, 2), moving});
  ASSERT_EQ(movers.size(), 1U);
  EXPECT_EQ(movers[0].class_name, "person");
}

}  // namespace
}  // namespace rtd::filter
