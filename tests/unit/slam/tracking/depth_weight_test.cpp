// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "services/slam/core/map/frame.hpp"
#include "services/slam/core/tracking/disagreement.hpp"
#include "services/slam/core/tracking/readout_estimator.hpp"

namespace rtd::slam {
namespace {

constexpr vision::RgbdProjection kWeighingCamera{500, 500, 320, 240};

/// A frame that shows 300 points at 1 to 4 m with these errors (standard deviations), seen from the origin.
struct NoisyFrame {
  Frame frame;
  std::vector<Association> points;

  NoisyFrame(double pixel_px, double inverse_depth_per_m, std::uint32_t seed, std::uint32_t count = 300) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> u(20, 620), v(20, 460), z(1, 4);
    frame.camera = kWeighingCamera;
    for (std::uint32_t i = 0; i < count; ++i) {
      msg::Feature feature{};
      const double u_px = u(random), v_px = v(random), z_m = z(random);
      feature.u_px = static_cast<float>(u_px + pixel_px * normal(random));
      feature.v_px = static_cast<float>(v_px + pixel_px * normal(random));
      feature.depth_m = static_cast<float>(1 / (1 / z_m + inverse_depth_per_m * normal(random)));
      frame.features.push_back(feature);
      points.push_back({i,
                        i,
                        {(u_px - kWeighingCamera.cx) / kWeighingCamera.fx * z_m,
                         (v_px - kWeighingCamera.cy) / kWeighingCamera.fy * z_m, z_m}});
    }
  }
};

double after(int frames, double pixel_px, double inverse_depth_per_m, std::uint32_t points = 300) {
  DepthWeightEstimator estimator;
  for (int i = 0; i < frames; ++i) {
    const NoisyFrame seen(pixel_px, inverse_depth_per_m, static_cast<std::uint32_t>(i), points);
    estimator.add(seen.frame, Eigen::Isometry3d::Identity(), seen.points);
  }
  return estimator.disparity_px_m();
}

TEST(DepthWeight, starts_with_a_weight_that_suits_most) {
  EXPECT_EQ(DepthWeightEstimator().disparity_px_m(), 80.0);
  EXPECT_EQ(DepthWeightEstimator(70.0).disparity_px_m(), 70.0);
}

TEST(DepthWeight, follows_the_ratio_of_the_errors) {
  EXPECT_NEAR(after(100, 1.0, 1.0 / 150), 67.5, 7.0);
  EXPECT_NEAR(after(100, 1.0, 1.0 / 50), 22.5, 3.5);
  EXPECT_NEAR(after(100, 0.5, 0.5 / 150), 67.5, 7.0);
}

TEST(DepthWeight, the_first_frames_change_it_little) {
  EXPECT_NEAR(after(1, 1.0, 1.0 / 50), 68.0, 5.0);
}

TEST(DepthWeight, stays_within_bounds_without_noise) {
  EXPECT_NEAR(after(100, 0.01, 0), 80.0, 8.0);
  EXPECT_NEAR(after(100, 0.01, 0.1), 10.0, 1.0);
}

TEST(DepthWeight, learns_nothing_from_few_points_or_without_depth) {
  EXPECT_EQ(after(100, 1.0, 1.0 / 50, 20), 80.0);
  NoisyFrame seen(1.0, 1.0 / 50, 1);
  for (msg::Feature& feature : seen.frame.features) feature.depth_m = 0;
  DepthWeightEstimator estimator;
  for (int i = 0; i < 100; ++i) estimator.add(seen.frame, Eigen::Isometry3d::Identity(), seen.points);
  EXPECT_EQ(estimator.disparity_px_m(), 80.0);
}

TEST(ReadoutEstimator, continues_from_what_a_map_knows) {
  EXPECT_NEAR(ReadoutEstimator(0.02).readout_s(), 0.02, 1e-12) << "sure from the first frame on";
  EXPECT_LT(ReadoutEstimator(0.02).sigma_s(), 0.005) << "but other frames may correct it";
  EXPECT_EQ(ReadoutEstimator(0).readout_s(), 0);
}

/// A camera 1 m in front of its map's origin; what it rejects is added thing by thing.
class DisagreementTest : public ::testing::Test {
 protected:
  DisagreementTest() {
    frame_->seq = 7;
    frame_->camera = {520, 520, 320, 240, 40};
    frame_->width_px = 640;
    frame_->height_px = 480;
    evidence_.T_world_camera =
        Eigen::Isometry3d(Eigen::Translation3d(0.1, 0, 1)) * Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitY());
    evidence_.agreeing = 200;
  }

  /// Landmarks on a thing around `center_m` (world) that has moved since.
  void add_thing(std::uint32_t landmarks, const Eigen::Vector3d& center_m, const Eigen::Vector3d& moved_m) {
    std::uniform_real_distribution<double> part(-0.3, 0.3);
    for (std::uint32_t i = 0; i < landmarks; ++i) {
      const Eigen::Vector3d p_world = center_m + Eigen::Vector3d(part(random_), part(random_), part(random_));
      see(p_world, evidence_.T_world_camera.inverse() * (p_world + moved_m));
    }
  }
  /// Landmarks that were taken for others.
  void add_mismatches(std::uint32_t landmarks) {
    std::uniform_real_distribution<double> side(-0.8, 0.8), depth(1.5, 4);
    for (std::uint32_t i = 0; i < landmarks; ++i)
      see({side(random_), side(random_), depth(random_) + 1}, {side(random_), side(random_), depth(random_)});
  }
  void see(const Eigen::Vector3d& p_world, const Eigen::Vector3d& p_camera) {
    msg::Feature feature{};
    feature.u_px = static_cast<float>(520 * p_camera.x() / p_camera.z() + 320);
    feature.v_px = static_cast<float>(520 * p_camera.y() / p_camera.z() + 240);
    feature.u_raw_px = feature.u_px + 3;
    feature.v_raw_px = feature.v_px - 2;
    feature.depth_m = static_cast<float>(p_camera.z());
    evidence_.rejected.push_back({static_cast<std::uint32_t>(frame_->features.size()), 9, p_world});
    frame_->features.push_back(feature);
  }
  Disagreement explained() {
    evidence_.frame = frame_;
    return explain(evidence_);
  }

  std::mt19937 random_{3};
  std::shared_ptr<Frame> frame_ = std::make_shared<Frame>();
  PoseEvidence evidence_;
};

TEST_F(DisagreementTest, finds_the_motion_that_many_landmarks_follow) {
  add_thing(40, {0, 0, 3.5}, {0.12, 0, -0.05});
  add_mismatches(15);
  const Disagreement found = explained();
  ASSERT_EQ(found.motions.size(), 1U);
  EXPECT_NEAR(found.motions[0].landmarks, 40, 2);
  EXPECT_LT((found.motions[0].moved_m - Eigen::Vector3d(0.12, 0, -0.05)).norm(), 0.005);
  EXPECT_LT((found.motions[0].center_m - Eigen::Vector3d(0, 0, 3.5)).norm(), 0.1);
  ASSERT_EQ(found.landmarks.size(), 55U);
  EXPECT_TRUE(std::ranges::all_of(found.landmarks.begin(), found.landmarks.begin() + 40,
                                  [](const Disagreeing& one) { return one.motion == 0; }));
  EXPECT_LE(std::ranges::count(found.landmarks.begin() + 40, found.landmarks.end(), 0, &Disagreeing::motion), 2);
}

TEST_F(DisagreementTest, distinguishes_two_things) {
  add_thing(40, {-0.6, 0, 3.5}, {0.15, 0, 0});
  add_thing(25, {0.6, 0, 3.5}, {-0.1, 0.05, 0});
  const Disagreement found = explained();
  ASSERT_EQ(found.motions.size(), 2U);
  EXPECT_LT((found.motions[0].moved_m - Eigen::Vector3d(0.15, 0, 0)).norm(), 0.005);
  EXPECT_LT((found.motions[1].moved_m - Eigen::Vector3d(-0.1, 0.05, 0)).norm(), 0.005);
  EXPECT_EQ(found.landmarks.front().motion, 0);
  EXPECT_EQ(found.landmarks.back().motion, 1);
}

TEST_F(DisagreementTest, mismatches_and_noise_are_no_motion) {
  add_mismatches(60);
  add_thing(20, {0, 0, 3.5}, {0.003, 0, 0});
  const Disagreement found = explained();
  EXPECT_TRUE(found.motions.empty());
  EXPECT_EQ(found.landmarks.size(), 80U);
}

TEST_F(DisagreementTest, shows_where_a_landmark_is_and_where_it_should_be_in_the_cameras_own_image) {
  see({0.1, 0, 3}, {0.2, 0, 2});
  evidence_.T_world_camera = Eigen::Isometry3d(Eigen::Translation3d(0.1, 0, 1));
  const Disagreement found = explained();
  ASSERT_EQ(found.landmarks.size(), 1U);
  EXPECT_TRUE(found.landmarks[0].seen_px.isApprox(Eigen::Vector2d(320 + 52 + 3, 240 - 2), 1e-6));
  EXPECT_TRUE(found.landmarks[0].expected_px.isApprox(Eigen::Vector2d(320 + 3, 240 - 2), 1e-6));
  evidence_.raster_scale = 2;  // of an image that was doubled
  EXPECT_NEAR(explained().landmarks[0].expected_px.x(), 320 + 52 + 3 - 26, 1e-3);
}

TEST_F(DisagreementTest, nothing_measured_disagrees_with_nothing) {
  EXPECT_TRUE(explain({}).landmarks.empty());
  EXPECT_TRUE(explained().motions.empty());
}

}  // namespace
}  // namespace rtd::slam
