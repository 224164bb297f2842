// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/atlas_trial.hpp"

#include <cmath>

#include "tests/support/atlas_robot.hpp"

namespace rtd::test_support {
namespace {

/// Where a robot was, as it has it and in truth.
struct Pairs {
  std::vector<Eigen::Vector3d> estimate, truth;

  void add(const eval::AteResult& result) {
    const Eigen::Isometry3d T = result.alignment.T_groundtruth_estimate.inverse();
    for (const eval::AtePoint& point : result.points) {
      estimate.push_back(T * point.estimate_m);
      truth.push_back(point.groundtruth_m);
    }
  }
  Pairs moved(const Eigen::Isometry3d& T) const {
    Pairs pairs = *this;
    for (Eigen::Vector3d& p : pairs.estimate) p = T * p;
    return pairs;
  }
};

/// The first answer to the question where a robot is.
struct FirstPose {
  std::int64_t stamp_ns = 0;  ///< 0: none
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> p_truth;
};

Eigen::Matrix3Xd columns(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Matrix3Xd matrix(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) matrix.col(static_cast<Eigen::Index>(i)) = points[i];
  return matrix;
}

double rmse_m(const Pairs& pairs, const eval::Alignment& alignment) {
  double sum = 0;
  for (std::size_t i = 0; i < pairs.truth.size(); ++i)
    sum += (alignment * pairs.estimate[i] - pairs.truth[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(pairs.truth.size()));
}

}  // namespace

TrialResult run_atlas_trial(const std::vector<TrialRobot>& robots, const OfflineOptions& options,
                            const atlas::AtlasConfig& config) {
  constexpr int kTellEvery = 15;
  atlas::Atlas atlas(config);
  TrialResult result;
  std::vector<Pairs> pairs;
  std::vector<FirstPose> firsts(robots.size());
  for (const TrialRobot& robot : robots) {
    TrialResult::Robot& entry = result.robots.emplace_back();
    entry.name = robot.name;
    FirstPose& first = firsts[result.robots.size() - 1];
    OfflineOptions own = options;
    own.source = robot.source;
    own.first_frame = robot.first_frame;
    own.max_frames = robot.max_frames;
    std::optional<AtlasTeller> teller;
    int frames = 0;
    std::int64_t first_ns = 0, last_ns = 0;
    own.on_start = [&](slam::SlamSystem& slam) { teller.emplace(robot.name, slam); };
    own.on_features = [&](const camera::SourceFrame& frame, const std::vector<msg::Feature>& features) {
      if (frames % kTellEvery != 0 || entry.first_pose_s >= 0) return;
      const auto submap = atlas.locate(query_of(*make_feature_frame(frame.image, features)));
      if (first_ns == 0) first_ns = frame.image.stamp_ns;
      if (!submap) return;
      entry.first_pose_s = 1e-9 * static_cast<double>(frame.image.stamp_ns - first_ns);
      first.stamp_ns = frame.image.stamp_ns;
      first.p_map = msg::to_isometry(submap->T_map_camera).translation();
    };
    own.on_frame = [&](const slam::SlamOutput& output) {
      last_ns = output.result.stamp_ns;
      if (++frames % kTellEvery == 0) teller->tell(atlas);
    };
    own.on_end = [&](slam::SlamSystem&) { teller->tell(atlas); };
    const OfflineReport report = run_offline(own);
    pairs.emplace_back().add(eval::ate(report.trajectory, report.groundtruth));
    if (first.stamp_ns != 0) {
      const eval::GroundtruthLookup lookup(report.groundtruth, 0);
      if (const Eigen::Isometry3d* truth = lookup.find(first.stamp_ns)) first.p_truth = truth->translation();
    }
    entry.ate_alone_m = report.ate_rmse_m;
    entry.add_ms = 1e3 * eval::summarize(teller->add_s).mean;
    entry.straighten_ms = 1e3 * eval::summarize(teller->straighten_s).mean;
    entry.kilobytes_per_s = 1e-3 * static_cast<double>(teller->bytes_sent) * 30 / frames;
  }
  Pairs all;
  const msg::AtlasState state = atlas.state();
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const msg::AtlasRobot& found = robot_in(state, robots[i].name);
    TrialResult::Robot& entry = result.robots[i];
    entry.met = found.met;
    entry.meetings = found.meetings;
    entry.keyframes = found.keyframes;
    pairs[i] = pairs[i].moved(msg::to_isometry(found.T_map_robot));
    if (!found.met) continue;
    all.estimate.insert(all.estimate.end(), pairs[i].estimate.begin(), pairs[i].estimate.end());
    all.truth.insert(all.truth.end(), pairs[i].truth.begin(), pairs[i].truth.end());
  }
  const eval::Alignment alignment = eval::align(columns(all.estimate), columns(all.truth), eval::AlignmentKind::kRigid);
  for (std::size_t i = 0; i < robots.size(); ++i) {
    result.robots[i].ate_joint_m = rmse_m(pairs[i], alignment);
    if (firsts[i].p_truth)
      result.robots[i].first_pose_error_m = (alignment * firsts[i].p_map - *firsts[i].p_truth).norm();
  }
  result.ate_joint_m = rmse_m(all, alignment);
  result.counters = atlas.counters();
  return result;
}

}  // namespace rtd::test_support
