// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
/// Loop closing on a world of points: a camera walks a circle, once round and a little further.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"
#include "services/slam/core/loop/essential_graph.hpp"
#include "services/slam/core/loop/global_bundle_adjustment.hpp"
#include "services/slam/core/loop/loop_closer.hpp"
#include "services/slam/core/place/vocabulary.hpp"
#include "services/slam/core/slam_system.hpp"
#include "tests/support/settled_map.hpp"
#include "tests/support/two_places.hpp"
#include "tests/support/walk_world.hpp"

namespace rtd::slam {
namespace {

using geometry::Vector6d;
using msg::TrackingState;
using test_support::WalkWorld;

constexpr double kRadiusM = 6, kStepM = 0.2;
constexpr int kLap = static_cast<int>(2 * std::numbers::pi * kRadiusM / kStepM);

Eigen::Isometry3d true_pose(int i) {
  const double angle_rad = i * kStepM / kRadiusM;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T.translation() = kRadiusM * Eigen::Vector3d(1 - std::cos(angle_rad), 0, std::sin(angle_rad));
  return T;
}

WalkWorld sparse_world() {
  WalkWorld::Options options;
  options.points_per_m3 = 22;
  return WalkWorld(options);
}

/// A map made by hand: keyframes stand at given poses, features of one descriptor are one landmark.
class MapByHand {
 public:
  explicit MapByHand(double noise = 0) {
    WalkWorld::Options options;
    options.points_per_m3 = 15;
    options.detection_rate = 0.9;
    options.flipped_bits = 0;
    options.noise_px = noise;
    options.depth_noise_factor = 0.004 * noise;
    world_ = WalkWorld(options);
  }

  KeyframeId add(int i, const Eigen::Isometry3d& T_world_camera, KeyframeId parent) {
    const auto message = world_.view(static_cast<std::uint64_t>(i), true_pose(i));
    const FramePtr frame = make_frame(*message, SensorConfig{}).frame;
    const KeyframeId id = map.add_keyframe(frame, T_world_camera, parent);
    for (std::uint32_t f = 0; f < frame->features.size(); ++f) {
      if (frame->features[f].depth_m <= 0) continue;
      const auto known = landmarks_.find(frame->features[f].descriptor);
      if (known != landmarks_.end()) {
        if (map.add_observation(known->second, {id, f})) map.refresh_landmark(known->second);
        continue;
      }
      const LandmarkId landmark = map.add_landmark(T_world_camera * frame->unproject(f), {id, f});
      landmarks_[frame->features[f].descriptor] = landmark;
      map.refresh_landmark(landmark);
    }
    places.add(id, built_in_vocabulary()->describe(frame->features));
    return id;
  }
  /// What is seen from now on are other landmarks, also where they are the same points.
  void forget_landmarks() { landmarks_.clear(); }

  Map map;
  KeyframeDatabase places;

 private:
  WalkWorld world_{WalkWorld::Options{}};
  std::map<msg::Descriptor, LandmarkId> landmarks_;
};

/// Keyframes of one lap with a constant error of each step, seen as odometry sees them.
std::vector<Eigen::Isometry3d> drifted_lap(const Vector6d& step_error, int count) {
  std::vector<Eigen::Isometry3d> poses{true_pose(0)};
  for (int i = 1; i < count; ++i) {
    poses.push_back(poses.back() * true_pose(i - 1).inverse() * true_pose(i) * geometry::se3_exp(step_error));
  }
  return poses;
}

Vector6d small_error() {
  return (Vector6d() << 0.0005, -0.0004, 0.001, 0.0002, 0.0004, -0.0001).finished();
}

double worst_error_m(const Map& map) {
  double worst_m = 0;
  for (const auto& [id, keyframe] : map.keyframes()) {
    const int i = static_cast<int>(keyframe.frame->seq);
    worst_m = std::max(worst_m, (keyframe.T_world_camera.translation() - true_pose(i).translation()).norm());
  }
  return worst_m;
}

MapByHand drifted_map(int count) {
  MapByHand made(0.3);
  const std::vector<Eigen::Isometry3d> poses = drifted_lap(small_error(), count);
  for (int i = 0; i < count; ++i) {
    made.add(i, poses[static_cast<std::size_t>(i)], i == 0 ? kNoKeyframe : static_cast<KeyframeId>(i - 1));
  }
  return made;
}

TEST(EssentialGraph, holds_the_tree_strong_neighbours_and_loops) {
  MapByHand made = drifted_map(12);
  const EssentialGraph without = make_essential_graph(made.map, 0);
  EXPECT_EQ(without.keyframes.size(), 12U);
  EXPECT_TRUE(without.graph.nodes.front().fixed);
  EXPECT_GE(without.graph.edges.size(), 11U);
  for (const PoseGraphEdge& edge : without.graph.edges) {
    EXPECT_LT(edge.from, edge.to);
    const auto residual = evaluate_pose_graph_edge(without.graph.nodes[edge.from].T_world_node,
                                                   without.graph.nodes[edge.to].T_world_node, edge.T_from_to);
    EXPECT_LT(residual.value.norm(), 1e-9) << "the map contradicts itself only in loops";
  }
  made.map.remove_keyframe(5);
  made.map.add_loop({5, 11, true_pose(5).inverse() * true_pose(11), 100});
  const EssentialGraph with = make_essential_graph(made.map, 0);
  EXPECT_EQ(with.keyframes.size(), 11U);
  const PoseGraphEdge& last = with.graph.edges.back();
  EXPECT_EQ(with.keyframes[last.from], 4U) << "what keyframe 5 hung on";
  EXPECT_EQ(with.keyframes[last.to], 11U);
}

TEST(EssentialGraph, landmarks_follow_their_keyframes) {
  MapByHand made = drifted_map(4);
  const LandmarkId landmark = made.map.find_keyframe(3)->landmarks.front() != kNoLandmark
                                  ? made.map.find_keyframe(3)->landmarks.front()
                                  : made.map.landmark_ids().back();
  const KeyframeId reference = made.map.find_landmark(landmark)->reference;
  const auto seen_from_reference = [&] {
    return Eigen::Vector3d(made.map.find_keyframe(reference)->T_world_camera.inverse() *
                           made.map.find_landmark(landmark)->position);
  };
  const Eigen::Vector3d before = seen_from_reference();
  move_component(made.map, 0, geometry::se3_exp(Vector6d::Constant(0.5)));
  EXPECT_LT((seen_from_reference() - before).norm(), 1e-9);
  EXPECT_EQ(made.map.check_invariants(), "");
}

TEST(GlobalBundleAdjustment, takes_the_drift_out_of_a_lap_whose_ends_see_the_same_points) {
  MapByHand made = drifted_map(kLap + 6);
  const double before_m = worst_error_m(made.map);
  GlobalProblem problem = copy_global_problem(made.map, 0), again = problem;
  adjust_globally(problem, {.iterations = 20, .threads = 1, .interrupted = {}});
  adjust_globally(again, {.iterations = 20, .threads = 1, .interrupted = {}});
  for (std::size_t i = 0; i < problem.keyframes.size(); ++i) {
    ASSERT_EQ(problem.bundle.cameras[i].T_world_camera.matrix(), again.bundle.cameras[i].T_world_camera.matrix());
  }
  apply_global_problem(made.map, problem);
  EXPECT_GT(before_m, 0.2);
  EXPECT_LT(worst_error_m(made.map), 0.1 * before_m);
  EXPECT_EQ(made.map.check_invariants(), "");
}

TEST(GlobalBundleAdjustment, keyframes_and_landmarks_made_meanwhile_survive_it) {
  MapByHand made = drifted_map(30);
  GlobalProblem problem = copy_global_problem(made.map, 0);
  const Eigen::Isometry3d T_parent_new = true_pose(29).inverse() * true_pose(30);
  const KeyframeId meanwhile = made.add(30, made.map.find_keyframe(29)->T_world_camera * T_parent_new, 29);
  const KeyframeId grandchild = made.add(31, made.map.find_keyframe(meanwhile)->T_world_camera, meanwhile);
  made.map.remove_keyframe(12);
  made.map.remove_landmark(problem.landmarks[7]);
  for (BundleCamera& camera : problem.bundle.cameras) camera.T_world_camera.translation().x() += 1;
  for (Eigen::Vector3d& point : problem.bundle.points) point.x() += 1;
  apply_global_problem(made.map, problem);
  EXPECT_EQ(made.map.check_invariants(), "");
  const Eigen::Isometry3d T_parent_after =
      made.map.find_keyframe(29)->T_world_camera.inverse() * made.map.find_keyframe(meanwhile)->T_world_camera;
  EXPECT_TRUE(T_parent_after.isApprox(T_parent_new, 1e-9));
  EXPECT_NEAR(made.map.find_keyframe(grandchild)->T_world_camera.translation().x() -
                  made.map.find_keyframe(meanwhile)->T_world_camera.translation().x(),
              0, 1e-9);
  for (const LandmarkId id : made.map.landmark_ids()) {
    const Landmark& landmark = *made.map.find_landmark(id);
    const Eigen::Vector3d seen =
        made.map.find_keyframe(landmark.reference)->T_world_camera.inverse() * landmark.position;
    ASSERT_GT(seen.z(), 0) << "landmark " << id << " was left behind";
  }
}

TEST(GlobalAdjuster, in_the_background_it_can_be_cancelled_and_reports_when_it_is_done) {
  const MapByHand made = drifted_map(25);
  std::atomic<int> done{0};
  GlobalAdjuster adjuster({.iterations = 10, .threads = 1, .interrupted = {}});
  adjuster.run_in_background([&] { ++done; });
  adjuster.start(copy_global_problem(made.map, 0));
  adjuster.cancel();
  EXPECT_FALSE(adjuster.take());
  const int before = done;
  adjuster.start(copy_global_problem(made.map, 0));
  adjuster.wait();
  EXPECT_EQ(done, before + 1);
  EXPECT_TRUE(adjuster.take());
  EXPECT_FALSE(adjuster.take()) << "only once";
}

SlamConfig patient() {
  SlamConfig config = test_support::settled();
  config.loop.min_inliers = 40;
  return config;
}

TEST(LoopCloser, merges_the_younger_map_into_the_older_one) {
  MapByHand made(0.3);
  for (int i = 0; i < 20; ++i) made.add(i, true_pose(i), i == 0 ? kNoKeyframe : static_cast<KeyframeId>(i - 1));
  made.forget_landmarks();
  const Eigen::Isometry3d T_second_world = true_pose(8).inverse();  // the second map's origin is its first camera
  LoopCloser closer(patient());
  std::optional<LoopClosure> closure;
  KeyframeId newest = kNoKeyframe;
  for (int i = 8; i < 18 && !closure; ++i) {
    newest = made.add(i, T_second_world * true_pose(i), newest);
    closure = closer.close(made.map, made.places, newest);
  }
  ASSERT_TRUE(closure);
  EXPECT_TRUE(closure->merged);
  EXPECT_EQ(closure->map, 0U);
  EXPECT_EQ(made.map.keyframe_count(1), 0U);
  EXPECT_EQ(made.map.check_invariants(), "");
  EXPECT_LT(worst_error_m(made.map), 0.02);
  EXPECT_GT(closure->joined, 50) << "landmarks became one";
  EXPECT_FALSE(made.map.find_keyframe(newest)->covisible.empty());
}

TEST(LoopCloser, believes_no_correction_that_drift_cannot_explain) {
  MapByHand made(0.3);
  for (int i = 0; i < 20; ++i) made.add(i, true_pose(i), i == 0 ? kNoKeyframe : static_cast<KeyframeId>(i - 1));
  made.forget_landmarks();
  // The very same views, seven metres on: the same textures at another place.
  const Eigen::Isometry3d T_elsewhere(Eigen::Translation3d(0, 0, 7));
  LoopCloser closer(patient());
  for (int i = 8; i < 18; ++i) {
    const KeyframeId newest = made.add(i, T_elsewhere * true_pose(i), static_cast<KeyframeId>(i + 11));
    EXPECT_FALSE(closer.close(made.map, made.places, newest));
  }
  EXPECT_GT(closer.counters().implausible, 3U);
}

struct Lap {
  std::vector<double> errors_m;
  std::vector<LoopClosure> loops;
  double largest_odometry_step_m = 0, largest_map_step_m = 0;
};

/// A lap with a calibration that is 2 % off: each turn is over-estimated.
Lap walk(bool loop_closing) {
  WalkWorld world = sparse_world();
  SlamConfig config = patient();
  config.techniques.loop_closing = loop_closing;
  SlamSystem slam(config, MappingMode::kSynchronous, [] { return std::int64_t{0}; });
  Lap lap;
  std::optional<Eigen::Isometry3d> T_odom_before, T_map_before;
  for (int i = 0; i < kLap + 16; ++i) {
    const auto message = world.view(static_cast<std::uint64_t>(i), true_pose(i));
    message->intrinsics[0] *= 1.02;
    message->intrinsics[1] *= 1.02;
    const SlamOutput output = slam.process(*message);
    EXPECT_EQ(output.result.state, msg::TrackingState::kOk) << i << ": " << output.problem;
    EXPECT_LE(output.changes.size(), 48U);
    const Eigen::Isometry3d T_map = output.result.T_world_camera;
    const Eigen::Isometry3d T_odom = output.T_map_odom.inverse() * T_map;
    if (T_odom_before) {
      const auto step_m = [](const auto& a, const auto& b) { return (b.translation() - a.translation()).norm(); };
      lap.largest_odometry_step_m = std::max(lap.largest_odometry_step_m, step_m(*T_odom_before, T_odom));
      lap.largest_map_step_m = std::max(lap.largest_map_step_m, step_m(*T_map_before, T_map));
    }
    T_odom_before = T_odom;
    T_map_before = T_map;
  }
  slam.finish();
  int i = 0;
  for (const StampedPose& pose : slam.trajectory()) {
    lap.errors_m.push_back((pose.T_world_body.translation() - true_pose(i++).translation()).norm());
  }
  lap.loops = slam.loops();
  return lap;
}

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(LoopClosing, a_lap_ends_where_it_began_and_the_odometry_does_not_jump) {
  const Lap open = walk(false), closed = walk(true);
  EXPECT_TRUE(open.loops.empty());
  ASSERT_FALSE(closed.loops.empty());
  EXPECT_GT(rms(open.errors_m), 0.2);
  EXPECT_LT(rms(closed.errors_m), 0.3 * rms(open.errors_m));
  EXPECT_GT(closed.largest_map_step_m, kStepM + 0.1) << "the correction is a jump in the map ...";
  EXPECT_LT(closed.largest_odometry_step_m, kStepM + 0.05) << "... and none in the odometry";
  std::printf("rms error %.3f -> %.3f m, largest step %.3f m in the map, %.3f m in the odometry, %zu loops\n",
              rms(open.errors_m), rms(closed.errors_m), closed.largest_map_step_m, closed.largest_odometry_step_m,
              closed.loops.size());
}

// A camera that is carried away with its eyes shut begins a map of its own; when it walks back, the two become one.

constexpr double kStep_m = 0.05, kFarEnd_m = -3;

class TwoPlaces : public ::testing::Test {
 protected:
  FrameResult look_from(double x_m) {
    T_world_camera_.translation().x() = x_m;
    return show(*places_.view(next_, T_world_camera_));
  }
  FrameResult look_at_nothing() { return show(*test_support::make_empty_view(next_)); }
  FrameResult show(const msg::FeatureFrame& frame) {
    ++next_;
    return slam_.process(frame).result;
  }
  double error_m(const FrameResult& result) const {
    return (result.T_world_camera.translation() - T_world_camera_.translation()).norm();
  }

 private:
  test_support::TwoPlaces places_;
  SlamSystem slam_{test_support::settled(), MappingMode::kSynchronous, [] { return std::int64_t{0}; }};
  Eigen::Isometry3d T_world_camera_ = Eigen::Isometry3d::Identity();
  std::uint64_t next_ = 0;
};

TEST_F(TwoPlaces, become_one_map_when_the_lost_camera_walks_back) {
  double x_m = 0;
  const auto walk_to = [&](double end_m, std::uint32_t while_maps) {
    const double step_m = end_m > x_m ? kStep_m : -kStep_m;
    FrameResult result;
    for (result.maps = while_maps; std::abs(end_m - x_m) > kStep_m / 2 && result.maps == while_maps; x_m += step_m) {
      result = look_from(x_m);
      EXPECT_EQ(result.state, TrackingState::kOk) << "at " << x_m << " m";
    }
    return result;
  };
  walk_to(1.5, 1);
  walk_to(kFarEnd_m, 1);
  for (int i = 0; i < 60; ++i) ASSERT_NE(look_at_nothing().state, TrackingState::kOk);

  x_m = test_support::TwoPlaces::kHallX_m + 2;  // nothing of the desk is seen from here
  FrameResult result;
  for (int i = 0; i < 120 && result.state != TrackingState::kOk; ++i) result = look_from(x_m);
  ASSERT_EQ(result.state, TrackingState::kOk) << "no new map in four seconds";
  EXPECT_EQ(result.map_id, 1U);
  EXPECT_EQ(result.maps, 2U);

  result = walk_to(kFarEnd_m, 2);
  ASSERT_EQ(result.maps, 1U);
  result = look_from(x_m);
  ASSERT_EQ(result.state, TrackingState::kOk);
  EXPECT_EQ(result.map_id, 0U);
  EXPECT_LT(error_m(result), 0.02) << "in the world of the first map";
}

}  // namespace
}  // namespace rtd::slam
