// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/atlas_trial.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

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
  constexpr int kReportEvery = 15;
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
      if (frames % kReportEvery != 0 || entry.first_pose_s >= 0) return;
      const auto submap = atlas.locate(query_of(*make_feature_frame(frame.image, features)));
      if (first_ns == 0) first_ns = frame.image.stamp_ns;
      if (!submap) return;
      entry.first_pose_s = 1e-9 * static_cast<double>(frame.image.stamp_ns - first_ns);
      first.stamp_ns = frame.image.stamp_ns;
      first.p_map = msg::to_isometry(submap->T_map_camera).translation();
    };
    own.on_frame = [&](const slam::SlamOutput& output) {
      last_ns = output.result.stamp_ns;
      if (++frames % kReportEvery == 0) teller->report(atlas);
    };
    own.on_end = [&](slam::SlamSystem&) { teller->report(atlas); };
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

namespace {

/// The keyframes of one walk.
struct Walk {
  std::vector<msg::KeyframeFeatures> features;
  std::vector<Eigen::Isometry3d> T_map_camera;
};

Walk walk_once(const OfflineOptions& source) {
  Walk walk;
  OfflineOptions own = source;
  own.on_end = [&](slam::SlamSystem& slam) {
    slam.read_map([&](const slam::Map& map) {
      for (const auto& [id, keyframe] : map.keyframes()) {
        walk.features.push_back(slam::make_features(map, keyframe, true));
        walk.T_map_camera.push_back(keyframe.T_world_camera);
      }
      return 0;
    });
  };
  run_offline(own);
  return walk;
}

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

}  // namespace

ScaleResult run_scale_trial(const OfflineOptions& source, int robots, int seconds, const atlas::AtlasConfig& config) {
  constexpr int kPerSecond = 2;
  constexpr std::int64_t kSessionNs = 1, kPeriodNs = 1'000'000'000 / kPerSecond;
  const Walk walk = walk_once(source);
  atlas::Atlas atlas(config);
  ScaleResult result;
  std::vector<double> took_ms;
  const std::clock_t cpu = std::clock();
  const auto start = std::chrono::steady_clock::now();
  for (int step = 0; step < seconds * kPerSecond; ++step) {
    for (int robot = 0; robot < robots; ++robot) {
      const std::string name = "robot" + std::to_string(robot);
      const std::size_t at = static_cast<std::size_t>(step + 3 * robot) % walk.features.size();
      const int round = (step + 3 * robot) / static_cast<int>(walk.features.size());
      Eigen::Isometry3d T_own_map = Eigen::Isometry3d::Identity();
      T_own_map.translation().x() = robot;
      msg::KeyframeFeatures features = walk.features[at];
      features.session_ns = kSessionNs;
      features.keyframe_id = static_cast<std::uint32_t>(step);
      features.stamp_ns = step * kPeriodNs + robot;
      for (msg::KeyframeFeature& feature : features.features)
        if (feature.landmark_id != msg::kNoId) feature.landmark_id += 100'000U * static_cast<std::uint32_t>(round);
      msg::MapUpdate update;
      update.session_ns = kSessionNs;
      msg::MapKeyframe& entry = update.keyframes.emplace_back();
      entry.keyframe_id = features.keyframe_id;
      entry.stamp_ns = features.stamp_ns;
      entry.T_world_camera = msg::to_message(T_own_map * walk.T_map_camera[at]);
      const auto began = std::chrono::steady_clock::now();
      atlas.follow(name, update);
      atlas.add(name, features);
      atlas.straighten();
      took_ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count());
      ++result.keyframes;
    }
  }
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.cpu_s = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  result.p99_ms = eval::percentile(took_ms, 0.99);
  result.longest_ms = *std::ranges::max_element(took_ms);
  result.kept = atlas.map().keyframes().size();
  result.peak_mb = peak_mb();
  result.all_met = std::ranges::all_of(atlas.state().robots, &msg::AtlasRobot::met);
  return result;
}

}  // namespace rtd::test_support
