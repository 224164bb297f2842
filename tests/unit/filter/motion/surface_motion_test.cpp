// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "common/geometry/se3.hpp"
#include "common/vision/samples.hpp"
#include "services/filter/core/motion/undecided_surfaces.hpp"
#include "tests/unit/filter/orb/test_images.hpp"

namespace rtd::filter {
namespace {

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
