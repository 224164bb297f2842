// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/slam_system.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"
#include "tests/support/feature_world.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;
using test_support::FeatureWorld;
using test_support::frozen_clock;

constexpr std::uint64_t kFrames = 90;

/// The features are those of a camera that is known exactly.
SlamSystem make_slam(MappingMode mode = MappingMode::kSynchronous) {
  SlamConfig config;
  config.sensor.calibration_error = 0;
  return {config, mode, frozen_clock};
}

std::unique_ptr<msg::FeatureFrame> empty_view(std::uint64_t seq) {
  auto frame = FeatureWorld({}).view(seq, Eigen::Isometry3d::Identity());
  frame->count = 0;
  return frame;
}

double position_error_m(const Eigen::Isometry3d& estimate, std::uint64_t seq) {
  return (estimate.translation() - FeatureWorld::T_world_camera(seq).translation()).norm();
}

TEST(SlamSystem, follows_the_camera_through_an_exact_world) {
  const FeatureWorld world({});
  SlamSystem slam = make_slam();
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    const SlamOutput output = slam.process(*world.view(seq));
    ASSERT_EQ(output.result.state, TrackingState::kOk) << "frame " << seq << ": " << output.problem;
    EXPECT_LT(position_error_m(output.result.T_world_camera, seq), 1e-3) << "frame " << seq;
  }
}

TEST(SlamSystem, the_first_pose_says_where_the_world_is) {
  const FeatureWorld world({});
  SlamConfig config;
  config.first_pose = geometry::se3_exp((geometry::Vector6d() << 0.2, 0, 0.5, -1.2, 1.2, -1.2).finished());
  SlamSystem slam(config, MappingMode::kSynchronous, frozen_clock);
  SlamSystem usual(SlamConfig(), MappingMode::kSynchronous, frozen_clock);
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    const SlamOutput output = slam.process(*world.view(seq));
    ASSERT_EQ(output.result.state, TrackingState::kOk) << "frame " << seq << ": " << output.problem;
    const Eigen::Isometry3d expected = config.first_pose * FeatureWorld::T_world_camera(seq);
    EXPECT_TRUE(output.result.T_world_camera.isApprox(expected, 2e-3)) << "frame " << seq;
    EXPECT_TRUE(output.T_map_odom.isApprox(Eigen::Isometry3d::Identity(), 1e-9)) << "odom begins where map does";
    const double trace = usual.process(*world.view(seq)).result.covariance.trace();
    EXPECT_NEAR(output.result.covariance.trace(), trace, 0.1 * trace) << "frame " << seq;
  }
  slam.reset();
  const SlamOutput again = slam.process(*world.view(0));
  EXPECT_TRUE(again.result.T_world_camera.isApprox(config.first_pose, 1e-9)) << "also after a reset";
}

/// A view of the world, with a floor 1 m below the first camera whose normal this is.
std::unique_ptr<msg::FeatureFrame> view_with_floor(std::uint64_t seq, const Eigen::Vector3d& up_world) {
  auto frame = FeatureWorld({.points = 600}).view(seq);
  const Eigen::Isometry3d T_camera_world = FeatureWorld::T_world_camera(seq).inverse();
  const auto is_below = [&](const msg::Feature& feature) {
    const double z = static_cast<double>(feature.depth_m);
    const Eigen::Vector3d p_camera((static_cast<double>(feature.u_px) - FeatureWorld::kCx) / FeatureWorld::kFx * z,
                                   (static_cast<double>(feature.v_px) - FeatureWorld::kCy) / FeatureWorld::kFy * z, z);
    return up_world.dot(FeatureWorld::T_world_camera(seq) * p_camera) < -1;
  };
  const auto end = frame->features.begin() + frame->count;
  frame->count =
      static_cast<std::uint32_t>(std::remove_if(frame->features.begin(), end, is_below) - frame->features.begin());
  std::mt19937_64 points(3), random(seq);
  for (int i = 0; i < 200; ++i) {
    const auto between = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(points() % 10'000) / 10'000;
    };
    Eigen::Vector3d p(between(-1, 1), 0, between(1.8, 3.5));
    p.y() = -(1 + up_world.x() * p.x() + up_world.z() * p.z()) / up_world.y();  // up_world . p = -1
    msg::Descriptor descriptor;
    for (auto& word : descriptor) word = static_cast<std::remove_reference_t<decltype(word)>>(points());
    const Eigen::Vector3d p_camera = T_camera_world * p;
    const double u = FeatureWorld::kFx * p_camera.x() / p_camera.z() + FeatureWorld::kCx;
    const double v = FeatureWorld::kFy * p_camera.y() / p_camera.z() + FeatureWorld::kCy;
    if (u < 1 || v < 1 || u > FeatureWorld::kWidth - 2 || v > FeatureWorld::kHeight - 2) continue;
    test_support::add_feature(*frame, {u, v, p_camera.z(), 0, 0}, descriptor, 0, random);
  }
  return frame;
}

/// Of a camera that looks horizontally, in a world with z up.
const Eigen::Isometry3d kLevelCamera(Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5));

Eigen::Vector3d up_in_camera(const Eigen::Isometry3d& T_world_camera) {
  return T_world_camera.linear().transpose() * Eigen::Vector3d::UnitZ();
}

SlamSystem slam_with(Gravity gravity, int wait_frames = 3) {
  SlamConfig config;
  config.first_pose = kLevelCamera;
  config.gravity = gravity;
  config.prior.imu = gravity == Gravity::kImu;
  config.gravity_wait_frames = wait_frames;
  return {config, MappingMode::kSynchronous, frozen_clock};
}

TEST(SlamSystem, a_map_begins_upright_when_the_floor_is_seen) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.15, -1, -0.3).normalized();
  SlamSystem slam = slam_with(Gravity::kFloor);
  for (std::uint64_t seq = 0; seq < 10; ++seq) {
    const SlamOutput output = slam.process(*view_with_floor(seq, up));
    ASSERT_EQ(output.result.state, TrackingState::kOk) << output.problem;
    const Eigen::Vector3d expected = FeatureWorld::T_world_camera(seq).linear().transpose() * up;
    EXPECT_LT((up_in_camera(output.result.T_world_camera) - expected).norm(), 0.005) << "rad, frame " << seq;
    EXPECT_TRUE(output.T_map_odom.isApprox(Eigen::Isometry3d::Identity(), 1e-9)) << "odom begins where map does";
    EXPECT_EQ(output.up.has_value(), seq == 0);
    if (!output.up) continue;
    EXPECT_TRUE(output.up->found);
    EXPECT_NEAR(output.up->turned_rad, std::acos(-up.y()), 0.005);
    EXPECT_NEAR(output.up->height_m, 1, 0.01);
    EXPECT_LT(output.result.T_world_camera.translation().norm(), 1e-9) << "turned about its origin";
  }
}

TEST(SlamSystem, a_map_begins_as_told_when_no_floor_has_come_into_view) {
  const FeatureWorld world({});
  SlamSystem slam = slam_with(Gravity::kFloor, 3);
  for (std::uint64_t seq = 0; seq < 3; ++seq) {
    const SlamOutput output = slam.process(*world.view(seq));
    EXPECT_EQ(output.result.state, TrackingState::kInitializing);
    EXPECT_NE(output.problem.find("up"), std::string::npos) << output.problem;
    EXPECT_FALSE(output.up);
  }
  const SlamOutput output = slam.process(*world.view(3));
  EXPECT_EQ(output.result.state, TrackingState::kOk);
  ASSERT_TRUE(output.up);
  EXPECT_FALSE(output.up->found);
  EXPECT_EQ(output.up->frames, 3);
  EXPECT_TRUE(output.result.T_world_camera.isApprox(kLevelCamera, 1e-12));
}

TEST(SlamSystem, a_map_waits_for_an_imu_at_rest_that_knows_what_is_up) {
  const FeatureWorld world({});
  const Eigen::Vector3d up = Eigen::Vector3d(0.1, -1, 0.2).normalized();
  SlamSystem slam = slam_with(Gravity::kImu);
  EXPECT_EQ(slam.process(*world.view(0)).result.state, TrackingState::kInitializing);
  for (std::int64_t i = 0; i <= 120; ++i)
    slam.add(ImuSample{FeatureWorld::stamp_ns(1) + (i - 120) * 5'000'000, Eigen::Vector3d::Zero(), 9.81 * up});
  const SlamOutput output = slam.process(*world.view(1));
  EXPECT_EQ(output.result.state, TrackingState::kOk);
  EXPECT_LT((up_in_camera(output.result.T_world_camera) - up).norm(), 1e-9);
}

TEST(SlamSystem, after_a_reset_the_next_map_is_upright_again_and_the_odometry_goes_on) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.15, -1, -0.3).normalized();
  SlamSystem slam = slam_with(Gravity::kFloor);
  const auto in_odom = [](const SlamOutput& output) {
    return output.T_map_odom.inverse() * output.result.T_world_camera;
  };
  SlamOutput before;
  for (std::uint64_t seq = 0; seq < 5; ++seq) before = slam.process(*view_with_floor(seq, up));
  slam.reset();
  const SlamOutput after = slam.process(*view_with_floor(5, up));
  const Eigen::Vector3d expected = FeatureWorld::T_world_camera(5).linear().transpose() * up;
  EXPECT_LT((up_in_camera(after.result.T_world_camera) - expected).norm(), 0.005);
  EXPECT_TRUE(in_odom(after).isApprox(in_odom(before), 0.05));
}

TEST(SlamSystem, stays_within_a_centimetre_with_noise) {
  const FeatureWorld world = FeatureWorld::noisy();
  SlamSystem slam = make_slam();
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    const SlamOutput output = slam.process(*world.view(seq));
    ASSERT_EQ(output.result.state, TrackingState::kOk);
    EXPECT_LT(position_error_m(output.result.T_world_camera, seq), 0.01) << "frame " << seq;
    if (seq == 0) continue;
    const geometry::Matrix6d& covariance = output.result.covariance;
    const double sigma_m = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
    EXPECT_GT(sigma_m, 1e-5);
    EXPECT_LT(sigma_m, 0.01);
  }
  slam.finish();
  EXPECT_EQ(slam.trajectory().size(), kFrames);
  EXPECT_GE(slam.keyframes().size(), 2U);
  EXPECT_GT(slam.map_points().size(), 300U);
}

TEST(SlamSystem, gives_the_same_bits_twice) {
  const FeatureWorld world = FeatureWorld::noisy();
  std::array<std::string, 2> texts;
  for (std::string& text : texts) {
    SlamSystem slam = make_slam();
    for (std::uint64_t seq = 0; seq < kFrames; ++seq) slam.process(*world.view(seq));
    std::ostringstream out;
    geometry::write_tum_trajectory(out, slam.trajectory());
    write_ply(out, slam.map_points());
    text = out.str();
  }
  EXPECT_EQ(texts[0], texts[1]);
}

TEST(SlamSystem, ends_without_having_seen_a_frame) {
  for (const MappingMode mode : {MappingMode::kSynchronous, MappingMode::kThreaded}) {
    SlamSystem slam = make_slam(mode);
    slam.finish();
    EXPECT_TRUE(slam.trajectory().empty());
    EXPECT_TRUE(slam.map_points().empty());
  }
}

TEST(SlamSystem, maps_in_a_thread_as_well) {
  const FeatureWorld world = FeatureWorld::noisy();
  SlamSystem slam = make_slam(MappingMode::kThreaded);
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    ASSERT_EQ(slam.process(*world.view(seq)).result.state, TrackingState::kOk) << "frame " << seq;
  }
  slam.finish();
  const auto trajectory = slam.trajectory();
  ASSERT_EQ(trajectory.size(), kFrames);
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    EXPECT_LT((trajectory[seq].T_world_body.translation() - FeatureWorld::T_world_camera(seq).translation()).norm(),
              0.01);
  }
}

TEST(SlamSystem, is_lost_without_features_and_recovers) {
  const FeatureWorld world({});
  SlamConfig config;
  config.tracker.recently_lost_s = 0.14;  // five frames
  config.techniques.prediction = false;
  SlamSystem slam(config, MappingMode::kSynchronous, frozen_clock);
  std::uint64_t seq = 0;
  for (; seq < 20; ++seq) slam.process(*world.view(seq));
  const std::size_t tracked = slam.frames_tracked();
  for (; seq < 30; ++seq) {
    const SlamOutput output = slam.process(*empty_view(seq));
    EXPECT_EQ(output.result.state, seq < 25 ? TrackingState::kRecentlyLost : TrackingState::kLost) << "frame " << seq;
    EXPECT_FALSE(output.problem.empty());
  }
  EXPECT_EQ(slam.frames_tracked(), tracked) << "a pose was invented";
  for (int i = 0; i < 2; ++i) {  // found, but not believed at once
    EXPECT_EQ(slam.process(*world.view(seq++)).result.state, TrackingState::kRelocalizing);
    EXPECT_EQ(slam.frames_tracked(), tracked);
  }
  const SlamOutput back = slam.process(*world.view(seq));
  ASSERT_EQ(back.result.state, TrackingState::kOk) << back.problem;
  EXPECT_LT(position_error_m(back.result.T_world_camera, seq), 1e-3);
}

/// Of a view, 70 features of the world; the others look like nothing before.
std::unique_ptr<msg::FeatureFrame> mostly_hidden(const FeatureWorld& world, std::uint64_t seq) {
  auto frame = world.view(seq);
  const auto other = FeatureWorld({.seed = 100}).view(seq);
  for (std::uint32_t i = 70; i < frame->count; ++i) {
    frame->features[i].descriptor = other->features[i % other->count].descriptor;
  }
  return frame;
}

TEST(SlamSystem, few_landmarks_suffice_where_the_motion_leads) {
  const FeatureWorld world({});
  SlamSystem slam = make_slam();
  constexpr std::uint64_t kSeen = 20;
  for (std::uint64_t seq = 0; seq < kSeen; ++seq) slam.process(*world.view(seq));
  const SlamOutput expected = slam.process(*mostly_hidden(world, kSeen));
  EXPECT_EQ(expected.result.state, TrackingState::kOk) << expected.problem;
  EXPECT_LE(expected.result.inliers, 80U);
  EXPECT_LT(position_error_m(expected.result.T_world_camera, kSeen), 0.01);
}

TEST(SlamSystem, finds_back_after_a_jump) {
  const FeatureWorld world({});
  SlamSystem slam = make_slam();
  for (std::uint64_t seq = 0; seq < 10; ++seq) slam.process(*world.view(seq));
  constexpr std::uint64_t kFar = 30;  // half a metre and twenty degrees away, in the next frame
  auto jumped = world.view(10, FeatureWorld::T_world_camera(kFar));
  const SlamOutput output = slam.process(*jumped);
  ASSERT_EQ(output.result.state, TrackingState::kOk) << output.problem;
  EXPECT_LT(position_error_m(output.result.T_world_camera, kFar), 1e-3);
}

TEST(SlamSystem, stays_initializing_without_depth) {
  const FeatureWorld world({});
  SlamSystem slam = make_slam();
  for (std::uint64_t seq = 0; seq < 3; ++seq) {
    auto frame = world.view(seq);
    for (msg::Feature& feature : frame->features) feature.depth_m = 0;
    const SlamOutput output = slam.process(*frame);
    EXPECT_EQ(output.result.state, TrackingState::kInitializing);
    EXPECT_THAT(output.problem, ::testing::HasSubstr("depth"));
    EXPECT_TRUE(output.changes.empty());
  }
  EXPECT_EQ(slam.process(*world.view(3)).result.state, TrackingState::kOk);
}

TEST(SlamSystem, drops_features_with_impossible_values_and_counts_them) {
  const FeatureWorld world({});
  SlamSystem slam = make_slam();
  slam.process(*world.view(0));
  auto frame = world.view(1);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  frame->features[0].u_px = nan;
  frame->features[1].depth_m = nan;
  frame->features[2].depth_m = -1;
  frame->features[3].angle_rad = std::numeric_limits<float>::infinity();
  frame->features[4].static_probability = nan;
  frame->features[5].static_probability = 2;
  frame->features[6].octave = 8;
  const SlamOutput output = slam.process(*frame);
  EXPECT_EQ(output.invalid_features, 7U);
  EXPECT_EQ(output.result.state, TrackingState::kOk);
  EXPECT_LT(position_error_m(output.result.T_world_camera, 1), 1e-3);
}

TEST(SlamSystem, refuses_frames_without_intrinsics_or_size) {
  const FeatureWorld world({});
  SlamSystem slam = make_slam();
  auto frame = world.view(0);
  frame->intrinsics = {0, 0, 0, 0};
  EXPECT_THAT(slam.process(*frame).problem, ::testing::HasSubstr("intrinsics"));
  slam.process(*world.view(1));
  frame = world.view(2);
  for (const double readout_s : {0.11, -0.11, std::nan("")}) {
    frame->readout_s = readout_s;
    EXPECT_THAT(slam.process(*frame).problem, ::testing::HasSubstr("readout time")) << readout_s;
    EXPECT_EQ(slam.readout_s(), 0);
  }
  frame = world.view(2);
  frame->count = msg::kMaxFeatures + 1;
  const SlamOutput output = slam.process(*frame);
  EXPECT_NE(output.result.state, TrackingState::kOk);
  EXPECT_THAT(output.problem, ::testing::HasSubstr("out of range"));
  EXPECT_EQ(slam.process(*world.view(3)).result.state, TrackingState::kOk);
}

TEST(SlamSystem, keeps_its_map_when_the_source_starts_again) {
  const FeatureWorld world({});
  SlamSystem slam = make_slam();
  for (std::uint64_t seq = 0; seq < 40; ++seq) slam.process(*world.view(seq));
  const SlamOutput output = slam.process(*world.view(0));
  EXPECT_EQ(slam.source_restarts(), 1U);
  ASSERT_EQ(output.result.state, TrackingState::kOk) << output.problem;
  EXPECT_LT(position_error_m(output.result.T_world_camera, 0), 1e-3);
  EXPECT_EQ(slam.process(*world.view(1)).result.state, TrackingState::kOk);
}

TEST(SlamSystem, never_uses_removed_features) {
  const FeatureWorld world({});
  SlamSystem slam = make_slam();
  for (std::uint64_t seq = 0; seq < 30; ++seq) {
    auto frame = world.view(seq);
    std::uint32_t removed = 0;
    for (std::uint32_t i = 0; i < frame->count; ++i) {
      msg::Feature& feature = frame->features[i];
      if (feature.u_px >= 320) continue;
      // The left half moves: 0.5 m nearer and ten pixels further in each frame.
      feature.u_px = static_cast<float>((static_cast<std::uint64_t>(feature.u_px) + 10 * seq) % 320);
      feature.depth_m -= 0.5F;
      feature.flags = msg::kFeatureRemoved;
      ++removed;
    }
    const SlamOutput output = slam.process(*frame);
    ASSERT_EQ(output.result.state, TrackingState::kOk);
    EXPECT_EQ(output.result.features_removed, removed);
    EXPECT_LT(position_error_m(output.result.T_world_camera, seq), 1e-3) << "frame " << seq;
  }
}

TEST(SlamSystem, low_static_probability_takes_the_weight_from_moving_objects) {
  const FeatureWorld world({});
  SlamSystem slam = make_slam();
  double worst_m = 0;
  for (std::uint64_t seq = 0; seq < 30; ++seq) {
    auto frame = world.view(seq);
    for (std::uint32_t i = 0; i < frame->count; ++i) {
      msg::Feature& feature = frame->features[i];
      if (feature.u_px >= 200) continue;
      feature.v_px += 0.4F * static_cast<float>(seq);  // a third of the image creeps away, too slowly to be an outlier
      feature.static_probability = 0.01F;
    }
    const SlamOutput output = slam.process(*frame);
    ASSERT_EQ(output.result.state, TrackingState::kOk);
    worst_m = std::max(worst_m, position_error_m(output.result.T_world_camera, seq));
  }
  EXPECT_LT(worst_m, 2e-3);
}

TEST(SlamSystem, changes_are_the_whole_history_of_the_keyframes) {
  const FeatureWorld world = FeatureWorld::noisy();
  SlamSystem slam = make_slam();
  std::uint64_t changes = 0;
  std::set<std::uint32_t> known;
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    const SlamOutput output = slam.process(*world.view(seq));
    for (const KeyframeChange& change : output.changes) {
      switch (change.kind) {
        case KeyframeChange::Kind::kCreated:
          EXPECT_TRUE(known.insert(change.id).second);
          EXPECT_EQ(change.frame_seq, seq);
          break;
        case KeyframeChange::Kind::kCorrected:
          EXPECT_TRUE(known.count(change.id));
          break;
        case KeyframeChange::Kind::kRemoved:
          EXPECT_EQ(known.erase(change.id), 1U);
          break;
      }
    }
    changes += output.changes.size();
    EXPECT_EQ(output.result.event_count, changes);
    EXPECT_EQ(output.result.keyframes, known.size());
  }
}

}  // namespace
}  // namespace rtd::slam
