// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "common/geometry/se3.hpp"
#include "common/vision/samples.hpp"
#include "services/filter/core/motion/ego_motion.hpp"
#include "services/filter/core/motion/feature_votes.hpp"
#include "services/filter/core/motion/static_consensus.hpp"
#include "services/filter/core/motion/undecided_surfaces.hpp"
#include "tests/unit/filter/orb/test_images.hpp"

namespace rtd::filter {
namespace {

constexpr std::int64_t kNowNs = 100'000'000;

/// A camera that has turned and gone on for 0.1 s.
class EgoMotionTest : public ::testing::Test {
 protected:
  /// `count` features in a pixel rectangle, seen then and now; `depth_m` is measured or not.
  void add(int count, const cv::Rect& area, double depth_m, bool measured) {
    std::uniform_real_distribution<double> u(area.x, area.x + area.width), v(area.y, area.y + area.height);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d p_then = camera_.unproject({u(random_), v(random_)}, depth_m);
      const Eigen::Vector3d p_now = T_world_camera_.inverse() * p_then;
      msg::Feature feature{};
      for (std::uint8_t& byte : feature.descriptor) byte = static_cast<std::uint8_t>(random_());
      then_.features.push_back(placed(feature, p_then, measured));
      now_.push_back(placed(feature, p_now, measured));
      cluster_of_.push_back(measured ? 0 : -1);
    }
  }
  msg::Feature placed(msg::Feature feature, const Eigen::Vector3d& p_camera, bool measured) {
    std::normal_distribution<double> noise_px(0, 0.4);
    const Eigen::Vector2d pixel = camera_.project(p_camera);
    feature.u_px = static_cast<float>(pixel.x() + noise_px(random_));
    feature.v_px = static_cast<float>(pixel.y() + noise_px(random_));
    feature.depth_m = measured ? static_cast<float>(p_camera.z()) : 0;
    return feature;
  }
  EgoMotion estimate() {
    ViewStore views;
    views.add(then_);
    const vision::FeatureGrid grid(now_, 640, 480);
    const std::vector<char> excluded(now_.size(), 0);
    const DepthClusters clusters{{160, 120}, std::vector<std::int32_t>(160 * 120, 0), {9000}};
    const EgoMotionInput input{{now_, grid, camera_},        excluded, cluster_of_, clusters, views, kNowNs,
                               Eigen::Isometry3d::Identity()};
    return estimate_ego_motion(input, EgoMotionConfig{}, GeometryConfig{});
  }
  double error_m(const EgoMotion& ego) const {
    return (ego.T_world_camera.translation() - T_world_camera_.translation()).norm();
  }

  std::mt19937_64 random_{3};
  const geometry::CameraModel camera_ = test::pinhole();
  const Eigen::Isometry3d T_world_camera_ =
      geometry::se3_exp((geometry::Vector6d() << 0.02, 0, 0.01, 0.002, 0.02, 0.001).finished());
  View then_;
  std::vector<msg::Feature> now_;
  std::vector<int> cluster_of_;
};

TEST_F(EgoMotionTest, a_wall_beyond_the_range_of_depth_shows_how_the_camera_has_turned) {
  add(24, {260, 400, 120, 70}, 2.5, true);   // a piece of the floor: a turn hardly differs from a shift
  add(200, {60, 20, 500, 200}, 6.5, false);  // the wall
  const EgoMotion ego = estimate();
  ASSERT_TRUE(ego.reliable);
  EXPECT_LT(error_m(ego), 0.008);
}

TEST_F(EgoMotionTest, what_has_no_depth_votes_on_no_surface) {
  add(100, {60, 260, 500, 200}, 2.5, true);
  add(100, {60, 20, 500, 200}, 6.5, false);
  const EgoMotion ego = estimate();
  ASSERT_TRUE(ego.reliable);
  EXPECT_LE(ego.votes.shifts.size(), 100U);
}

TEST_F(EgoMotionTest, no_depth_next_to_something_near_is_its_shadow) {
  add(50, {60, 20, 500, 200}, 6.5, false);
  then_.grid.shape = {160, 120};
  const vision::FeatureGrid grid(now_, 640, 480);
  const auto matches = [&](float depth_m) {
    then_.grid.depth_m.assign(160 * 120, depth_m);
    return match_by_projection(then_, {now_, grid, camera_}, Eigen::Isometry3d::Identity(), 30, EgoMotionConfig{}, 0,
                               Unmeasured::kFar)
        .size();
  };
  EXPECT_EQ(matches(1.5F), 0U);
  EXPECT_GE(matches(4), 40U);
  EXPECT_GE(matches(0), 40U);
}

constexpr std::int64_t kMs = 1'000'000;
const Eigen::Vector3d kTurning_rad_s(0.3, -0.5, 0.2);

/// Half a second of samples at 200 Hz.
Gyroscope turning(const GyroscopeConfig& config, const Eigen::Vector3d& rate_rad_s) {
  Gyroscope gyroscope(config);
  for (std::int64_t i = 0; i <= 100; ++i) gyroscope.add({i * 5 * kMs, rate_rad_s, Eigen::Vector3d::Zero()});
  return gyroscope;
}

TEST(Gyroscope, turns_as_the_camera_does_whatever_way_it_is_mounted) {
  GyroscopeConfig config;
  config.R_camera_imu = geometry::so3_exp({0.5, 1.2, -0.7});
  const auto turn = turning(config, config.R_camera_imu.transpose() * kTurning_rad_s).turn(103 * kMs, 400 * kMs);
  ASSERT_TRUE(turn);
  EXPECT_TRUE(turn->R_earlier_later.isApprox(geometry::so3_exp(0.297 * kTurning_rad_s), 1e-9));
}

TEST(Gyroscope, is_as_uncertain_as_its_bias_scale_and_noise) {
  GyroscopeConfig config;
  config.scale_error = 0;
  const auto at_rest = turning(config, Eigen::Vector3d::Zero()).turn(100 * kMs, 200 * kMs);
  ASSERT_TRUE(at_rest);
  const double variance = std::pow(config.bias_rad_s * 0.1, 2) + std::pow(config.noise_rad_s_rthz, 2) * 0.1;
  EXPECT_TRUE(at_rest->covariance.isApprox(variance * Eigen::Matrix3d::Identity(), 1e-6));
  config.scale_error = 0.01;
  const auto turned = turning(config, kTurning_rad_s).turn(100 * kMs, 200 * kMs);
  ASSERT_TRUE(turned);
  EXPECT_NEAR(turned->covariance.trace() / 3, variance + std::pow(0.01 * 0.1 * kTurning_rad_s.norm(), 2), 1e-9);
}

TEST(Gyroscope, says_nothing_without_samples) {
  EXPECT_FALSE(Gyroscope({}).turn(0, 100 * kMs));
  Gyroscope gyroscope = turning({}, kTurning_rad_s);
  EXPECT_FALSE(gyroscope.turn(300 * kMs, 900 * kMs)) << "they end before";
  gyroscope.forget_before(400 * kMs);
  EXPECT_FALSE(gyroscope.turn(100 * kMs, 450 * kMs)) << "they begin later";
  EXPECT_TRUE(gyroscope.turn(400 * kMs, 450 * kMs));
  gyroscope.clear();
  EXPECT_FALSE(gyroscope.turn(400 * kMs, 450 * kMs));
}

TEST(Gyroscope, goes_by_the_clock_of_the_camera) {
  GyroscopeConfig config;
  config.time_offset_s = 10;
  EXPECT_FALSE(turning(config, kTurning_rad_s).turn(100 * kMs, 200 * kMs));
  EXPECT_TRUE(turning(config, kTurning_rad_s).turn(10'100 * kMs, 10'200 * kMs));
}

/// Points of a room in front of the camera and of a mover, seen from a camera that has moved.
class StaticConsensusTest : public ::testing::Test {
 protected:
  /// `count` points in a pixel rectangle at a depth, displaced by `moved_m` since the reference.
  void add(int count, const cv::Rect& area, double depth_m, int cluster,
           const Eigen::Vector3d& moved_m = Eigen::Vector3d::Zero()) {
    std::uniform_real_distribution<double> u(area.x, area.x + area.width), v(area.y, area.y + area.height);
    std::normal_distribution<double> noise_px(0, 0.5);
    for (int i = 0; i < count; ++i) {
      PointSighting s;
      s.pixel = {u(random_), v(random_)};
      s.depth_m = depth_m;
      s.p_world = T_world_camera_ * camera_.unproject(s.pixel, depth_m) - moved_m;
      s.pixel += Eigen::Vector2d(noise_px(random_), noise_px(random_));
      s.sigma_px = 1;
      s.cluster = cluster;
      sightings_.push_back(s);
    }
  }
  double error_m(const StaticConsensus& found) const {
    return (T_world_camera_.inverse() * found.T_world_camera).translation().norm();
  }
  StaticConsensus find() const {
    return find_static_consensus(sightings_, camera_, Eigen::Isometry3d::Identity(), EgoMotionConfig{});
  }
  std::mt19937_64 random_{5};
  geometry::CameraModel camera_ = test::pinhole();
  Eigen::Isometry3d T_world_camera_ =
      geometry::se3_exp((geometry::Vector6d() << 0.02, -0.01, 0.015, 0.004, -0.006, 0.003).finished());
  std::vector<PointSighting> sightings_;
};

TEST_F(StaticConsensusTest, finds_the_motion_in_a_static_room) {
  add(100, {0, 0, 640, 240}, 3.0, 0);
  add(100, {0, 240, 640, 240}, 2.0, 1);
  const StaticConsensus found = find();
  EXPECT_LT(error_m(found), 0.004) << "m";
  EXPECT_GT(found.image_share, 0.8);
}

TEST_F(StaticConsensusTest, follows_the_walls_although_the_mover_carries_more_features) {
  add(60, {0, 0, 640, 160}, 3.5, 0);
  add(60, {0, 400, 640, 80}, 2.5, 1);
  add(200, {220, 160, 160, 240}, 1.2, 2, {0.05, 0, 0});
  const StaticConsensus found = find();
  EXPECT_LT(error_m(found), 0.02) << "m, the mover went 0.05 m";
}

TEST_F(StaticConsensusTest, has_no_share_without_sightings) {
  EXPECT_EQ(find().image_share, 0);
}

TEST_F(StaticConsensusTest, survives_points_behind_the_camera_and_without_depth) {
  add(100, {0, 0, 640, 480}, 2.0, 0);
  for (std::size_t i = 0; i < 20; ++i) sightings_[i].p_world.z() = -2;
  for (std::size_t i = 20; i < 40; ++i) sightings_[i].depth_m = 0;
  EXPECT_LT(error_m(find()), 0.01) << "m";
}

TEST_F(StaticConsensusTest, lets_the_features_of_a_mover_vote_against_it) {
  add(100, {0, 0, 640, 160}, 3.5, 0);
  add(40, {220, 160, 160, 240}, 1.2, 1, {0.05, 0, 0});
  DepthClusters clusters{{160, 120}, std::vector<std::int32_t>(160 * 120, 0), {100, 100}};
  const FeatureVotes votes = count_votes(sightings_, camera_, T_world_camera_, clusters);
  EXPECT_FALSE(votes.cluster_moves(0, GeometryConfig{}));
  EXPECT_TRUE(votes.cluster_moves(1, GeometryConfig{}));
  EXPECT_FALSE(votes.cluster_moves(99, GeometryConfig{})) << "a cluster without votes";
}

/// A thing before a far wall, seen from a camera that has moved.
class SurfaceMotionTest : public ::testing::Test {
 protected:
  std::vector<PointSighting> make(int count, const cv::Rect& area, double depth_m,
                                  const Eigen::Vector3d& moved_m = Eigen::Vector3d::Zero()) {
    std::uniform_real_distribution<double> u(area.x, area.x + area.width), v(area.y, area.y + area.height);
    std::normal_distribution<double> noise(0, 1);
    std::vector<PointSighting> sightings(static_cast<std::size_t>(count));
    for (PointSighting& s : sightings) {
      s.pixel = {u(random_), v(random_)};
      s.sigma_px = 1;
      const double true_m = depth_m + 0.3 * noise(random_);  // a wall has things on it
      s.p_world = T_world_camera_ * camera_.unproject(s.pixel, true_m) - moved_m;
      s.depth_m = 0;
      s.pixel += Eigen::Vector2d(noise(random_), noise(random_));
    }
    return sightings;
  }
  std::optional<RelativeMotion> compare(const std::vector<PointSighting>& thing, const std::vector<PointSighting>& rest,
                                        const KnownRotation& rotation = {}) const {
    const auto motions = relative_motions({{0, thing}}, rest, camera_, Eigen::Isometry3d::Identity(), rotation);
    return motions.empty() ? std::nullopt : std::optional(motions.at(0));
  }
  /// A gyroscope's, that is off by a milliradian or so.
  vision::RotationPrior known_rotation() const {
    const Eigen::Matrix3d R = T_world_camera_.linear() * geometry::so3_exp({0.001, -0.001, 0.0005});
    return {R, 1e-6 * Eigen::Matrix3d::Identity()};
  }
  std::mt19937_64 random_{7};
  geometry::CameraModel camera_ = test::pinhole();
  Eigen::Isometry3d T_world_camera_ =
      geometry::se3_exp((geometry::Vector6d() << 0.02, -0.01, 0.015, 0.004, -0.006, 0.003).finished());
};

TEST_F(SurfaceMotionTest, of_a_thing_at_rest_is_chi2_with_three_degrees_of_freedom) {
  std::vector<double> distances2;
  for (int i = 0; i < 100; ++i) {
    const auto motion = compare(make(60, {240, 160, 160, 160}, 1.5), make(120, {0, 0, 640, 480}, 3.5));
    ASSERT_TRUE(motion);
    distances2.push_back(motion->distance2);
  }
  EXPECT_NEAR(vision::median(distances2), 2.4, 1.2);
  EXPECT_LT(*std::max_element(distances2.begin(), distances2.end()), 40);
}

TEST_F(SurfaceMotionTest, shows_five_centimetres) {
  const auto motion = compare(make(60, {240, 160, 160, 160}, 1.5, {0.05, 0, 0}), make(120, {0, 0, 640, 480}, 3.5));
  ASSERT_TRUE(motion);
  EXPECT_GT(motion->distance2, 40);
}

TEST_F(SurfaceMotionTest, is_less_certain_before_a_wall_with_few_features) {
  const auto thing = make(60, {240, 160, 160, 160}, 1.5);
  const auto many = compare(thing, make(200, {0, 0, 640, 480}, 3.5)),
             few = compare(thing, make(25, {0, 0, 640, 480}, 3.5));
  ASSERT_TRUE(many && few);
  EXPECT_LT(1.5 * many->sigma_m, few->sigma_m);
}

TEST_F(SurfaceMotionTest, is_decided_by_a_known_rotation_before_a_wall_with_few_features) {
  std::vector<double> alone, known, resting;
  for (int i = 0; i < 20; ++i) {
    const auto carried = make(60, {240, 160, 160, 160}, 1.5, {0.03, 0, 0}), still = make(60, {240, 160, 160, 160}, 1.5);
    const auto wall = make(25, {0, 0, 640, 480}, 3.5);
    const auto without = compare(carried, wall), with = compare(carried, wall, known_rotation());
    const auto rests = compare(still, wall, known_rotation());
    ASSERT_TRUE(without && with && rests);
    EXPECT_LT(with->sigma_m, without->sigma_m);
    alone.push_back(without->distance2);
    known.push_back(with->distance2);
    resting.push_back(rests->distance2);
  }
  EXPECT_LT(vision::median(alone), 40) << "open";
  EXPECT_GT(vision::median(known), 40) << "it moves";
  EXPECT_NEAR(vision::median(resting), 2.4, 1.8);
}

TEST_F(SurfaceMotionTest, is_unknown_with_too_few_sightings) {
  EXPECT_FALSE(compare(make(5, {240, 160, 160, 160}, 1.5), make(120, {0, 0, 640, 480}, 3.5)));
  EXPECT_FALSE(compare(make(60, {240, 160, 160, 160}, 1.5), make(10, {0, 0, 640, 480}, 3.5)));
  EXPECT_FALSE(compare({}, {}));
}

}  // namespace
}  // namespace rtd::filter
