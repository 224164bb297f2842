// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"
#include "services/slam/core/map/frame.hpp"
#include "services/slam/core/slam_system.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/offline_pipeline.hpp"
#include "tests/support/settled_map.hpp"

namespace rtd::slam {
namespace {

using test_support::FeatureWorld;

constexpr double kReadout_s = 0.02;

FeatureWorld noisy_world() {
  FeatureWorld::Options options;
  options.noise_px = 0.5;
  options.depth_noise_factor = 0.0015;
  return FeatureWorld(options);
}

/// Of the motion over half a second: the world itself is relative to the first frame, whose motion is unknown.
struct RunResult {
  double rotation_rmse_rad = 0, position_rmse_m = 0, readout_s = 0;
};

/// `frames_say_s`: what the frames say of the readout time.
RunResult run(double true_readout_s, const SlamConfig& config, double frames_say_s = 0) {
  constexpr std::uint64_t kFrames = 240, kSettled = 120, kSpan = 15;
  const FeatureWorld world = noisy_world();
  SlamSystem slam(config, MappingMode::kSynchronous, [] { return std::int64_t{0}; });
  std::vector<Eigen::Isometry3d> found;
  RunResult result;
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    const auto view = world.rolling_view(seq, true_readout_s);
    view->readout_s = frames_say_s;
    const SlamOutput output = slam.process(*view);
    EXPECT_EQ(output.result.state, msg::TrackingState::kOk) << "frame " << seq;
    found.push_back(output.result.T_world_camera);
    if (seq < kSettled) continue;
    const Eigen::Isometry3d true_motion =
        FeatureWorld::T_world_camera(seq - kSpan).inverse() * FeatureWorld::T_world_camera(seq);
    const Eigen::Isometry3d error = true_motion.inverse() * (found[seq - kSpan].inverse() * found[seq]);
    result.rotation_rmse_rad += std::pow(geometry::rotation_angle_rad(error), 2) / (kFrames - kSettled);
    result.position_rmse_m += error.translation().squaredNorm() / (kFrames - kSettled);
  }
  result.rotation_rmse_rad = std::sqrt(result.rotation_rmse_rad);
  result.position_rmse_m = std::sqrt(result.position_rmse_m);
  result.readout_s = slam.readout_s();
  return result;
}

TEST(RollingShutter, undoing_it_gives_the_view_of_the_middle_row) {
  const FeatureWorld world({});
  const auto rolling = world.rolling_view(20, kReadout_s);
  const auto still = world.view(20, FeatureWorld::T_world_camera(20));
  constexpr double kStep_s = 1e-4, kTime_s = 20 / 30.0;
  const Eigen::Isometry3d T_before_after =
      FeatureWorld::T_world_camera_at(kTime_s - kStep_s).inverse() * FeatureWorld::T_world_camera_at(kTime_s + kStep_s);
  const ShutterMotion motion{geometry::se3_log(T_before_after) / (2 * kStep_s), kReadout_s};
  const vision::RgbdProjection camera{FeatureWorld::kFx, FeatureWorld::kFy, FeatureWorld::kCx, FeatureWorld::kCy, 40};
  double largest_before = 0;
  int compared = 0;
  for (std::uint32_t i = 0; i < rolling->count; ++i) {
    const msg::Feature& seen = rolling->features[i];
    const auto* same = std::find_if(still->features.begin(), still->features.begin() + still->count,
                                    [&](const msg::Feature& other) { return other.descriptor == seen.descriptor; });
    if (same == still->features.begin() + still->count) continue;  // it left the image
    const msg::Feature undone = undo_rolling_shutter(seen, camera, FeatureWorld::kHeight, motion);
    ASSERT_NEAR(undone.u_px, same->u_px, 0.1);
    ASSERT_NEAR(undone.v_px, same->v_px, 0.1);
    ASSERT_NEAR(undone.depth_m, same->depth_m, 1e-3);
    largest_before = std::max<double>(largest_before, std::hypot(seen.u_px - same->u_px, seen.v_px - same->v_px));
    ++compared;
  }
  EXPECT_GT(compared, 300);
  EXPECT_GT(largest_before, 2.0) << "there was something to undo";
}

TEST(RollingShutter, a_feature_without_depth_follows_the_rotation_alone) {
  const vision::RgbdProjection camera{500, 500, 320, 240, 40};
  msg::Feature feature{};
  feature.u_px = 100;
  feature.v_px = 480;
  ShutterMotion motion;
  motion.readout_s = kReadout_s;
  motion.velocity_per_s << 1, 1, 1, 0, 0, 0;
  EXPECT_EQ(undo_rolling_shutter(feature, camera, 480, motion).u_px, 100);
  motion.velocity_per_s << 0, 0, 0, 0, 1, 0;
  EXPECT_NEAR(undo_rolling_shutter(feature, camera, 480, motion).u_px, 100 + 500 * 0.01 * (1 + 0.44 * 0.44), 0.2);
}

TEST(RollingShutter, the_readout_time_is_found_and_halves_the_error) {
  SlamConfig off = test_support::settled();
  off.techniques.rolling_shutter = false;
  const RunResult without = run(kReadout_s, off), with = run(kReadout_s, test_support::settled());
  EXPECT_NEAR(with.readout_s, kReadout_s, 0.25 * kReadout_s);
  EXPECT_LT(with.rotation_rmse_rad, 0.6 * without.rotation_rmse_rad);
  EXPECT_LT(with.position_rmse_m, 0.6 * without.position_rmse_m);
}

TEST(RollingShutter, a_known_readout_time_is_used_from_the_start) {
  SlamConfig known = test_support::settled();
  known.sensor.readout_s = kReadout_s;
  const RunResult result = run(kReadout_s, known);
  EXPECT_EQ(result.readout_s, kReadout_s);
  EXPECT_LE(result.rotation_rmse_rad, run(kReadout_s, test_support::settled()).rotation_rmse_rad * 1.1);
}

TEST(RollingShutter, what_the_frames_say_counts_as_what_is_configured) {
  SlamConfig known = test_support::settled();
  known.sensor.readout_s = kReadout_s;
  const RunResult configured = run(kReadout_s, known), said = run(kReadout_s, test_support::settled(), kReadout_s);
  EXPECT_EQ(said.readout_s, kReadout_s);
  EXPECT_EQ(said.rotation_rmse_rad, configured.rotation_rmse_rad);
  EXPECT_EQ(said.position_rmse_m, configured.position_rmse_m);
}

TEST(RollingShutter, what_is_configured_wins_over_what_the_frames_say) {
  SlamConfig known = test_support::settled();
  known.sensor.readout_s = kReadout_s;
  EXPECT_EQ(run(kReadout_s, known, -kReadout_s).readout_s, kReadout_s);
}

TEST(RollingShutter, a_global_shutter_is_left_alone) {
  const RunResult result = run(0, test_support::settled());
  EXPECT_EQ(result.readout_s, 0);
  EXPECT_LT(result.position_rmse_m, 0.005);
}

}  // namespace
}  // namespace rtd::slam

namespace rtd::test_support {
namespace {

OfflineReport run_rolling_scene(const std::string& timing) {
  OfflineOptions options;
  options.source = "synthetic:static?frames=150&rolling_shutter_ms=30&timing=" + timing;
  options.front_end.mode = "off";
  return run_offline(options);
}

TEST(SensorTiming, a_source_that_knows_its_readout_time_improves_the_trajectory_from_the_first_frame) {
  const OfflineReport unknown = run_rolling_scene("unknown"), known = run_rolling_scene("known");
  EXPECT_EQ(known.readout_s, 0.03);
  EXPECT_NE(unknown.readout_s, 0.03) << "estimated";
  EXPECT_EQ(known.coverage, 1);
  EXPECT_LT(known.ate_rmse_m, 0.7 * unknown.ate_rmse_m);
  RecordProperty("ate_unknown_m", std::to_string(unknown.ate_rmse_m));
  RecordProperty("ate_known_m", std::to_string(known.ate_rmse_m));
}

}  // namespace
}  // namespace rtd::test_support
