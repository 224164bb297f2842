// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/offline_pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <optional>
#include <sstream>
#include <thread>

#include "common/camera/open/source_factory.hpp"
#include "common/geometry/se3.hpp"
#include "services/evaluation/core/trajectory/evaluation.hpp"
#include "services/evaluation/core/trajectory/trajectory_error.hpp"
#include "tests/support/pose_error.hpp"

namespace rtd::test_support {
namespace {

void add_stage_times(const slam::FrameResult& result, OfflineReport& report) {
  static constexpr std::array<const char*, 6> kNames{"slam.match",    "slam.local_map", "slam.pose",
                                                     "slam.keyframe", "slam.mapping",   "slam.total"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    report.stage_ms[kNames[i]].push_back(static_cast<double>(result.stage_ms[i]));
  }
  report.stage_ms["slam.tracking"].push_back(
      static_cast<double>(result.stage_ms[msg::kStageSlamTotal] - result.stage_ms[msg::kStageMapping]));
}

constexpr std::int64_t kSettledAfterNs = 1'000'000'000;

std::optional<Eigen::Isometry3d> true_pose(const eval::Trajectory& groundtruth, std::int64_t stamp_ns) {
  const auto found = std::find_if(groundtruth.begin(), groundtruth.end(),
                                  [stamp_ns](const auto& pose) { return pose.stamp_ns == stamp_ns; });
  if (found == groundtruth.end()) return std::nullopt;
  return found->T_world_body;
}

struct MeanNees {
  double measured = 0, predicted = 0;  ///< NaN without such poses
};

/// Mean over the poses published in the first map, whose frame is that of its first pose.
MeanNees mean_nees(const std::vector<slam::FrameResult>& published, const eval::Trajectory& groundtruth) {
  constexpr std::size_t kFirst = 5;  // the first covariances are those of a map that has just begun
  std::optional<Eigen::Isometry3d> T_truth_world;
  struct {
    double sum = 0;
    std::size_t count = 0;
    double mean() const { return count == 0 ? std::nan("") : sum / static_cast<double>(count); }
  } measured, predicted;
  for (std::size_t i = 0; i < published.size(); ++i) {
    const auto truth = true_pose(groundtruth, published[i].stamp_ns);
    if (!truth) continue;
    if (!T_truth_world) T_truth_world = *truth * published[i].T_world_camera.inverse();
    if (i < kFirst) continue;
    auto& kind = msg::is_measured(published[i].state) ? measured : predicted;
    kind.sum += nees(published[i], T_truth_world->inverse() * *truth);
    ++kind.count;
  }
  return {measured.mean(), predicted.mean()};
}

eval::PublishedPose published_pose(const slam::FrameResult& result) {
  return {result.stamp_ns, result.state, result.T_world_camera, result.covariance, result.map_id};
}

eval::Trajectory camera_truth(const OfflineReport& report) {
  return eval::camera_truth(report.groundtruth, eval::find_body_offset(report.trajectory, report.groundtruth, 0));
}

void evaluate(const std::vector<slam::FrameResult>& published, OfflineReport& report) {
  const auto tracked = static_cast<double>(report.trajectory.size());
  const auto given = static_cast<double>(report.frames + report.frames_left_out);
  report.coverage = report.frames == 0 ? 0.0 : tracked / given;
  report.ate_rmse_m = eval::ate(report.trajectory, report.groundtruth).error_m.rmse;
  eval::Trajectory online;
  for (const slam::FrameResult& result : published) online.push_back({result.stamp_ns, result.T_world_camera});
  report.online_ate_rmse_m = eval::ate(online, report.groundtruth).error_m.rmse;
  const MeanNees nees = mean_nees(published, report.groundtruth);
  report.nees = nees.measured;
  report.predicted_nees = nees.predicted;
  const eval::RpeResult rpe = eval::rpe(report.trajectory, camera_truth(report));
  report.rpe_trans_rmse_m = rpe.translation_m.rmse;
  report.rpe_rot_rmse_deg = rpe.rotation_rad.rmse * 180 / std::numbers::pi;
}

/// With a prior, predicted poses count beside measured ones.
void judge_results(const std::vector<slam::FrameResult>& results, bool has_prior, OfflineReport& report) {
  std::vector<slam::FrameResult> judged;
  std::vector<eval::PublishedPose> published;
  for (const slam::FrameResult& result : results) {
    published.push_back(published_pose(result));
    const bool predicted = has_prior && result.state == msg::TrackingState::kPredicted;
    if (predicted) ++report.predicted_frames;
    if ((predicted || msg::is_measured(result.state)) && result.map_id == 0) judged.push_back(result);
  }
  evaluate(judged, report);
  const eval::Trajectory truth = camera_truth(report);
  report.integrity = eval::judge_integrity(published, truth);
  report.doubtful_frames = report.integrity.in_state[static_cast<std::size_t>(msg::TrackingState::kDoubtful)];
  report.drift = eval::measure_drift(eval::measured_poses(published), truth);
}

ClosedLoop judge(const slam::LoopClosure& closure, const eval::Trajectory& groundtruth) {
  ClosedLoop loop{closure, std::nan(""), std::nan("")};
  const auto older = true_pose(groundtruth, closure.older_ns), newer = true_pose(groundtruth, closure.newer_ns);
  if (!older || !newer) return loop;
  const Eigen::Isometry3d T_error = closure.edge.T_older_newer.inverse() * older->inverse() * *newer;
  loop.error_m = T_error.translation().norm();
  loop.error_rad = geometry::rotation_angle_rad(T_error);
  return loop;
}

/// The input of slam before the frame.
void add_motion(slam::SlamSystem& slam, const camera::SourceFrame& frame) {
  for (const camera::ImuReading& reading : frame.imu) {
    slam.add(inertial::ImuSample{reading.stamp_ns, reading.gyro_rad_s, reading.accel_m_s2});
  }
  for (const camera::WheelReading& reading : frame.wheels) {
    slam.add(slam::WheelSample{reading.stamp_ns, reading.T_odom_base});
  }
}

/// With IMU and wheels where the source has them.
slam::SlamConfig with_priors(slam::SlamConfig config, const camera::SourceInfo& info, bool imu) {
  config.prior.imu = imu;
  config.prior.wheels = info.has_wheels;
  if (info.has_wheels) config.prior.T_base_camera = info.T_base_camera;
  return config;
}

}  // namespace

std::unique_ptr<msg::FeatureFrame> make_feature_frame(const vision::RgbdImage& image,
                                                      const std::vector<msg::Feature>& features) {
  auto message = std::make_unique<msg::FeatureFrame>();
  message->seq = image.seq;
  message->stamp_ns = image.stamp_ns;
  const geometry::CameraModel::Parameters& camera = image.camera.parameters();
  message->intrinsics = {camera.fx, camera.fy, camera.cx, camera.cy};
  message->readout_s = image.readout_s;
  message->width = static_cast<std::uint32_t>(image.color_bgr.cols);
  message->height = static_cast<std::uint32_t>(image.color_bgr.rows);
  message->count = static_cast<std::uint32_t>(std::min<std::size_t>(features.size(), msg::kMaxFeatures));
  std::copy_n(features.begin(), message->count, message->features.begin());
  return message;
}

OfflineReport run_offline(const OfflineOptions& options) {
  const auto source = camera::make_source(options.source);
  const auto front_end = make_front_end(options.front_end);
  std::optional<ImuOfTruth> imu;
  if (options.imu_of_truth) imu.emplace(source->groundtruth(), *options.imu_of_truth, options.imu_seed);
  const bool has_imu = source->info().has_imu || (imu && options.imu_for_slam);
  slam::SlamSystem slam(with_priors(options.slam, source->info(), has_imu), options.mapping, options.now_ns);
  if (options.on_start) options.on_start(slam);
  OfflineReport report;
  std::vector<slam::FrameResult> results;
  ImageFaults image_faults(options.front_end.image_faults);
  const auto pass_over = [&source](std::size_t frames) {
    for (std::size_t i = 0; i < frames; ++i) source->next();
  };
  pass_over(options.first_frame);
  std::optional<std::int64_t> first_ns;
  auto next_frame = std::chrono::steady_clock::now();
  while (options.max_frames == 0 || report.frames < options.max_frames) {
    auto frame = source->next();
    if (!frame) break;
    if (imu) frame->imu = imu->until(frame->image.stamp_ns);
    image_faults.apply(*frame);
    const FrontEndOutput front = front_end->process(*frame);
    if (options.on_features) options.on_features(*frame, front.features);
    if (!first_ns) first_ns = frame->image.stamp_ns;
    if (!frame->dynamic_mask.empty() && frame->image.stamp_ns - *first_ns >= kSettledAfterNs) {
      report.removal.count(run_record::judged(front.features), frame->dynamic_mask);
    }
    const auto message = make_feature_frame(frame->image, front.features);
    for (const auto& [name, ms] : front.stage_ms) report.stage_ms[name].push_back(ms);
    std::this_thread::sleep_until(next_frame);
    next_frame = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                        std::chrono::duration<double>(options.min_period_s));
    add_motion(slam, *frame);
    const slam::SlamOutput output = slam.process(*message);
    front_end->listen(output);
    add_stage_times(output.result, report);
    report.keyframes = output.result.keyframes;
    report.landmarks = output.result.landmarks;
    ++report.frames;
    results.push_back(output.result);
    if (options.on_frame) options.on_frame(output);
    pass_over(options.frame_step - 1);
  }
  report.disparity_px_m = slam.disparity_px_m();
  report.readout_s = slam.readout_s();
  slam.finish();
  if (options.on_end) options.on_end(slam);
  std::ostringstream text;
  geometry::write_tum_trajectory(text, slam.trajectory());
  report.trajectory_tum = text.str();
  report.trajectory = slam.trajectory();
  report.groundtruth = source->groundtruth();
  const bool whole = options.max_frames == 0 && options.first_frame == 0 && options.frame_step == 1;
  if (whole) report.frames_left_out = source->counters().frames_left_out();
  for (const slam::LoopClosure& closure : slam.loops()) report.loops.push_back(judge(closure, report.groundtruth));
  judge_results(results, slam.prior() != nullptr, report);
  return report;
}

}  // namespace rtd::test_support
