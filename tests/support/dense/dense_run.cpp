// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/dense/dense_run.hpp"

#include <algorithm>
#include <ctime>
#include <opencv2/imgproc.hpp>

#include "common/camera/open/source_factory.hpp"
#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"
#include "services/evaluation/core/trajectory/trajectory_error.hpp"
#include "services/slam/slam_messages.hpp"

namespace rtd::test_support {
namespace {

constexpr std::int64_t kSameMomentNs = 20'000'000;

/// CPU time of this thread: what the map costs, whatever else the machine does.
double cpu_ms() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

dense::DynamicMask mask_of(const camera::SourceFrame& frame, const FrontEndOutput& front, const std::string& mode) {
  if (mode == "true-mask") {
    dense::DynamicMask mask{frame.dynamic_mask.cols / 4, frame.dynamic_mask.rows / 4, {}};
    cv::Mat cells;  // any moving pixel makes the cell one that moves
    cv::dilate(frame.dynamic_mask, cells, cv::Mat::ones(5, 5, CV_8UC1));
    cv::resize(cells, cells, {mask.columns, mask.rows}, 0, 0, cv::INTER_NEAREST);
    mask.cells.assign(cells.data, cells.data + cells.total());
    return mask;
  }
  if (front.motion.empty()) return dense::all_static();
  dense::DynamicMask mask{front.cells.columns, front.cells.rows, {}};
  for (const filter::CellMotion motion : front.motion) mask.cells.push_back(static_cast<std::uint8_t>(motion));
  return mask;
}

/// The true poses, in slam's world. Aligned by the rotations: a path of half a metre does not resolve a degree.
eval::Trajectory true_poses(const slam::SlamSystem& slam, const camera::FrameSource& source) {
  eval::Trajectory truth = source.groundtruth();
  const eval::Trajectory estimate = slam.trajectory();
  const auto pairs = geometry::associate(eval::stamps_of(truth), eval::stamps_of(estimate), kSameMomentNs);
  Eigen::Matrix3d rotations = Eigen::Matrix3d::Zero();
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  for (const geometry::StampPair& pair : pairs) {
    const Eigen::Isometry3d &T_truth = truth[pair.first].T_world_body, &T_slam = estimate[pair.second].T_world_body;
    rotations += T_slam.linear() * T_truth.linear().transpose();
    from += T_truth.translation() / static_cast<double>(pairs.size());
    to += T_slam.translation() / static_cast<double>(pairs.size());
  }
  Eigen::Isometry3d T_slam_truth = Eigen::Isometry3d::Identity();
  T_slam_truth.linear() = rotations / static_cast<double>(pairs.size());
  T_slam_truth = geometry::normalized(T_slam_truth);
  T_slam_truth.translation() = to - T_slam_truth.linear() * from;
  for (eval::StampedPose& pose : truth) pose.T_world_body = T_slam_truth * pose.T_world_body;
  return truth;
}

GhostReport judge(const DenseOptions& options, const std::vector<dense::CloudPoint>& cloud,
                  const eval::Trajectory& truth) {
  GhostMeasure measure(cloud);
  const auto source = camera::make_source(options.source);
  while (const auto frame = source->next()) {
    if (frame->image.seq % static_cast<std::uint64_t>(options.judge_every) != 0) continue;
    const auto pair = geometry::associate(eval::stamps_of(truth), {frame->image.stamp_ns}, kSameMomentNs);
    if (pair.empty()) continue;
    measure.judge(frame->image, frame->dynamic_mask, truth[pair[0].first].T_world_body);
  }
  return measure.report();
}

void make_grid(dense::NavigationMap& navigation, dense::StaticMap& map, DenseReport& report) {
  navigation.follow_corrections();
  const double start_ms = cpu_ms();
  report.volume = navigation.volume(map);
  report.grid = navigation.grid(report.volume);
  report.grid_ms = cpu_ms() - start_ms;
  report.scans = navigation.space().scans();
}

}  // namespace

DenseReport run_dense(const DenseOptions& options) {
  const auto source = camera::make_source(options.source);
  const auto front_end = make_front_end(options.front_end);
  slam::SlamConfig slam_config;
  slam_config.techniques.loop_closing = options.close_loops;
  if (options.grid) slam_config.first_pose = source->groundtruth().front().T_world_body;
  slam::SlamSystem slam(slam_config, slam::MappingMode::kSynchronous, service::monotonic_ns);
  dense::StaticMap map(options.map);
  dense::NavigationMap navigation(options.navigation, Eigen::Vector3d::UnitZ());
  DenseReport report;
  double total_ms = 0, total_grid_ms = 0;
  while (const auto frame = source->next()) {
    ++report.frames;
    const FrontEndOutput front = front_end->process(*frame);
    const slam::SlamOutput output = slam.process(*make_feature_frame(frame->image, front.features));
    front_end->listen(output);
    bool wanted = frame->image.seq % static_cast<std::uint64_t>(options.every) == 0;
    for (const msg::KeyframeEvent& event : slam::make_events(output)) {
      map.update(event);
      navigation.update(event);
      wanted = wanted || (event.kind == msg::KeyframeEventKind::kCreated && event.frame_seq == frame->image.seq);
    }
    if (!wanted || output.result.state != msg::TrackingState::kOk) continue;
    const dense::DynamicMask mask =
        options.use_masks ? mask_of(*frame, front, options.front_end.mode) : dense::all_static();
    const Eigen::Isometry3d T_world_camera = msg::to_isometry(slam::make_result(output.result).T_world_camera);
    const double start_ms = cpu_ms();
    const dense::FusionReport fusion = map.integrate(frame->image, mask, T_world_camera);
    total_ms += cpu_ms() - start_ms;
    if (options.grid) {
      const double grid_start_ms = cpu_ms();
      navigation.integrate(frame->image, T_world_camera);
      total_grid_ms += cpu_ms() - grid_start_ms;
    }
    ++report.integrated;
    report.fused += fusion.fused;
    report.masked += fusion.masked;
    report.carved += fusion.carved;
  }
  slam.finish();
  report.integrate_ms = total_ms / static_cast<double>(std::max<std::size_t>(1, report.integrated));
  if (options.grid) make_grid(navigation, map, report);
  report.grid_integrate_ms = total_grid_ms / static_cast<double>(std::max<std::size_t>(1, report.integrated));
  report.voxels = map.voxels();
  report.cloud = map.cloud();
  if (options.judge_every > 0) report.ghosts = judge(options, report.cloud, true_poses(slam, *source));
  return report;
}

}  // namespace rtd::test_support
