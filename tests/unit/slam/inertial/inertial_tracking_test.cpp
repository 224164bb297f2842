// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// What tracking makes of an IMU while there is nothing, or something wrong, to see.

#include <gtest/gtest.h>

#include <cmath>

#include "common/camera/synthetic/motion_sensors.hpp"
#include "services/slam/core/slam_system.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/pose_error.hpp"
#include "tests/support/settled_map.hpp"

namespace rtd::slam {
namespace {

using camera::synthetic::SyntheticImu;
using msg::TrackingState;
using test_support::FeatureWorld;
using test_support::frozen_clock;

/// A system that is shown views and, if wanted, what an IMU measures.
class InertialTracking : public ::testing::Test {
 protected:
  explicit InertialTracking(std::uint64_t seed = 1)
      : world_(FeatureWorld::noisy(seed)), imu_(FeatureWorld::T_world_camera_at, SyntheticImu::Options(), seed) {
    config_.sensor.calibration_error = 0;  // the camera is perfect
  }

  SlamSystem& slam() {
    if (!slam_) slam_.emplace(config_, MappingMode::kSynchronous, frozen_clock);
    return *slam_;
  }
  void feed_imu(std::uint64_t seq) {
    while (static_cast<double>(next_imu_) / 200 < static_cast<double>(seq) / 30 + 0.005) {
      const camera::ImuReading reading = imu_.reading(next_imu_++);
      slam().add(inertial::ImuSample{reading.stamp_ns + FeatureWorld::stamp_ns(0),
                                     reading.gyro_rad_s + gyro_error_rad_s_, reading.accel_m_s2});
    }
  }
  FrameResult show(std::uint64_t seq, std::unique_ptr<msg::FeatureFrame> view) {
    if (config_.prior.imu) feed_imu(seq);
    return slam().process(*view).result;
  }
  FrameResult show(std::uint64_t seq) { return show(seq, world_.view(seq)); }
  /// A view in which a person leaves only the first `count` features.
  std::unique_ptr<msg::FeatureFrame> covered(std::uint64_t seq, std::uint32_t count,
                                             const Eigen::Isometry3d& T_world_camera) const {
    auto view = world_.view(seq, T_world_camera);
    for (std::uint32_t i = count; i < view->count; ++i) view->features[i].flags = msg::kFeatureRemoved;
    return view;
  }
  static double error_m(const FrameResult& result) {
    return (result.T_world_camera.translation() - FeatureWorld::T_world_camera(result.seq).translation()).norm();
  }

  FeatureWorld world_;
  SyntheticImu imu_;
  SlamConfig config_ = test_support::settled();
  std::optional<SlamSystem> slam_;
  std::int64_t next_imu_ = 0;
  Eigen::Vector3d gyro_error_rad_s_ = Eigen::Vector3d::Zero();  ///< more than its bias
};

TEST_F(InertialTracking, continues_for_three_seconds_without_a_view) {
  config_.prior.imu = true;
  std::uint64_t seq = 0;
  for (; seq < 90; ++seq) ASSERT_EQ(show(seq).state, TrackingState::kOk);
  double nees = 0;
  for (; seq < 180; ++seq) {
    const FrameResult result = show(seq, covered(seq, 0, FeatureWorld::T_world_camera(seq)));
    ASSERT_EQ(result.state, TrackingState::kPredicted) << "frame " << seq;
    EXPECT_LT(error_m(result), 0.1) << "frame " << seq;
    nees += test_support::nees(result, FeatureWorld::T_world_camera(seq)) / 90;
  }
  EXPECT_LT(nees, 12) << "95 % of single ways have less";
  for (; seq < 200; ++seq) {
    const FrameResult result = show(seq);
    EXPECT_EQ(result.state, TrackingState::kOk) << "frame " << seq;
    EXPECT_LT(error_m(result), 0.02);
  }
  EXPECT_EQ(slam().trajectory().size(), 200U) << "predicted poses by IMU belong to the trajectory";
}

TEST_F(InertialTracking, the_view_that_comes_back_corrects_the_predicted_part_of_the_trajectory) {
  config_.prior.imu = true;
  constexpr std::uint64_t kFrom = 75, kTo = 165;  // covered
  double published_m2 = 0, final_m2 = 0;
  for (std::uint64_t seq = 0; seq < 200; ++seq) {
    const bool hidden = seq >= kFrom && seq < kTo;
    const FrameResult result = hidden ? show(seq, covered(seq, 0, FeatureWorld::T_world_camera(seq))) : show(seq);
    if (hidden) published_m2 += std::pow(error_m(result), 2);
  }
  const std::vector<StampedPose> trajectory = slam().trajectory();
  ASSERT_EQ(trajectory.size(), 200U);
  for (std::uint64_t seq = kFrom; seq < kTo; ++seq) {
    const Eigen::Vector3d p = trajectory[seq].T_world_body.translation();
    final_m2 += (p - FeatureWorld::T_world_camera(seq).translation()).squaredNorm();
  }
  EXPECT_LT(std::sqrt(final_m2 / 90), 0.0013) << "m";
  EXPECT_GT(std::sqrt(published_m2 / 90), 0.01) << "m: published poses stay as they are";
}

TEST_F(InertialTracking, claims_nothing_once_the_position_is_uncertain) {
  config_.prior.imu = true;
  config_.prior.max_sigma_m = 0.02;
  std::uint64_t seq = 0;
  for (; seq < 60; ++seq) show(seq);
  TrackingState state = TrackingState::kPredicted;
  for (; seq < 360 && state == TrackingState::kPredicted; ++seq) {
    const FrameResult result = show(seq, covered(seq, 0, FeatureWorld::T_world_camera(seq)));
    state = result.state;
    if (state == TrackingState::kPredicted) {
      EXPECT_LT(error_m(result), 0.1);
    }
  }
  EXPECT_EQ(state, TrackingState::kRecentlyLost);
  EXPECT_LT(seq, 360U);
}

TEST_F(InertialTracking, a_person_who_fills_the_view_does_not_take_the_pose_along) {
  config_.prior.imu = true;
  const auto worst_m = [this] {
    double worst = 0;
    std::uint64_t seq = 0;
    for (; seq < 75; ++seq) show(seq);
    for (; seq < 120; ++seq) {
      // What is left of the view moves off by 1 m/s.
      Eigen::Isometry3d T_world_camera = FeatureWorld::T_world_camera(seq);
      T_world_camera.translation().x() += static_cast<double>(seq - 74) / 30;
      const FrameResult result = show(seq, covered(seq, 60, T_world_camera));
      if (msg::has_pose(result.state)) worst = std::max(worst, error_m(result));
    }
    return worst;
  };
  const double with_imu_m = worst_m();
  config_.prior.imu = false;
  slam_.reset();
  const double without_m = worst_m();
  EXPECT_LT(with_imu_m, 0.05);
  EXPECT_GT(without_m, 0.2);
}

TEST_F(InertialTracking, a_prediction_that_has_drifted_does_not_hold_against_the_view_that_comes_back) {
  config_.prior.imu = true;
  config_.prior.weak_support = 1;  // however many landmarks agree
  std::uint64_t seq = 0;
  for (; seq < 75; ++seq) show(seq);
  gyro_error_rad_s_.x() = 0.03;  // as if the bias had been learnt beside something that moves
  for (; seq < 120; ++seq) show(seq, covered(seq, 0, FeatureWorld::T_world_camera(seq)));
  for (; seq < 165; ++seq) {
    const FrameResult result = show(seq);
    EXPECT_EQ(result.state, seq < 151 ? TrackingState::kDoubtful : TrackingState::kOk) << "for a second: " << seq;
    EXPECT_LT(error_m(result), 0.02) << "m, frame " << seq;
  }
}

TEST_F(InertialTracking, an_imu_that_is_not_received_changes_nothing) {
  std::vector<FrameResult> without, with;
  for (std::uint64_t seq = 0; seq < 60; ++seq) without.push_back(show(seq));
  slam_.reset();
  config_.prior.imu = true;
  for (std::uint64_t seq = 0; seq < 60; ++seq) with.push_back(slam().process(*world_.view(seq)).result);
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_TRUE(with[i].T_world_camera.matrix() == without[i].T_world_camera.matrix()) << "frame " << i;
    EXPECT_EQ(with[i].state, without[i].state);
  }
}

TEST_F(InertialTracking, knows_which_way_is_up) {
  config_.prior.imu = true;
  for (std::uint64_t seq = 0; seq < 120; ++seq) show(seq);
  const auto up = slam().prior()->up_in_camera();
  ASSERT_TRUE(up);
  const Eigen::Vector3d truth = FeatureWorld::T_world_camera(119).linear().transpose() * Eigen::Vector3d::UnitZ();
  EXPECT_LT(std::acos(std::min(1.0, up->dot(truth))), 0.01) << "rad";
}

}  // namespace
}  // namespace rtd::slam
