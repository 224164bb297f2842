// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/atlas_trial.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <ctime>
#include <functional>
#include <future>
#include <limits>
#include <mutex>

#include "tests/support/atlas_robot.hpp"

namespace rtd::test_support {
namespace {

/// Where a robot was, as the joint map has it and in truth.
struct Pairs {
  std::vector<Eigen::Vector3d> estimate, truth;

  explicit Pairs(const eval::AteResult& result = {}) {
    const Eigen::Isometry3d T = result.alignment.T_groundtruth_estimate.inverse();
    for (const eval::AtePoint& point : result.points) {
      estimate.push_back(T * point.estimate_m);
      truth.push_back(point.groundtruth_m);
    }
  }
  void append(const Pairs& other) {
    estimate.insert(estimate.end(), other.estimate.begin(), other.estimate.end());
    truth.insert(truth.end(), other.truth.begin(), other.truth.end());
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

eval::Alignment align(const Pairs& pairs) {
  return eval::align(columns(pairs.estimate), columns(pairs.truth), eval::AlignmentKind::kRigid);
}

/// What a walk leaves behind for the sum of all.
struct Walked {
  eval::Trajectory alone, groundtruth;  ///< `alone`: of the robot's own map
  eval::Trajectory live;                ///< in the joint map as it was with each frame, from the first meeting on
  FirstPose first;
};

/// Robots that walk at the same time take turns, frame by frame: what comes of it does not depend on their threads.
class Turns {
 public:
  explicit Turns(std::size_t robots) : frames_(robots, 0) {}

  void wait_for(std::size_t robot) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] {
      return std::ranges::min_element(frames_) - frames_.begin() == static_cast<std::ptrdiff_t>(robot);
    });
  }
  void pass_on(std::size_t robot) { set(robot, frames_[robot] + 1); }
  void leave(std::size_t robot) { set(robot, std::numeric_limits<std::size_t>::max()); }

 private:
  void set(std::size_t robot, std::size_t frames) {
    const std::lock_guard lock(mutex_);
    frames_[robot] = frames;
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::size_t> frames_;  ///< that each has walked
};

/// Asks for the place of every so-many-th frame until one is found, and takes note of when and where.
class PlaceSeeker {
 public:
  PlaceSeeker(const atlas::Atlas& atlas, TrialResult::Robot& entry) : atlas_(atlas), entry_(entry) {}

  void look(const camera::SourceFrame& frame, const std::vector<msg::Feature>& features) {
    if (entry_.first_pose_s >= 0) return;
    const std::int64_t stamp_ns = frame.image.stamp_ns;
    const auto submap = atlas_.locate(query_of(*make_feature_frame(frame.image, features)));
    if (asked_ns_ == 0) asked_ns_ = stamp_ns;
    if (!submap) return;
    entry_.first_pose_s = 1e-9 * static_cast<double>(stamp_ns - asked_ns_);
    first_ = {stamp_ns, msg::to_isometry(submap->T_map_camera).translation(), std::nullopt};
  }
  FirstPose first(const eval::Trajectory& groundtruth) const {
    FirstPose first = first_;
    if (first.stamp_ns == 0) return first;
    const eval::GroundtruthLookup lookup(groundtruth, 0);
    if (const Eigen::Isometry3d* truth = lookup.find(first.stamp_ns)) first.p_truth = truth->translation();
    return first;
  }

 private:
  const atlas::Atlas& atlas_;
  TrialResult::Robot& entry_;
  std::int64_t asked_ns_ = 0;
  FirstPose first_;
};

/// `turns`: null for a robot that walks alone, hours after the one before it.
Walked walk(const TrialRobot& robot, std::size_t number, Turns* turns, const OfflineOptions& options,
            atlas::Atlas& atlas, TrialResult::Robot& entry) {
  constexpr std::int64_t kHourNs = 3'600'000'000'000;
  constexpr int kReportEvery = 15;
  OfflineOptions own = options;
  own.source = robot.source;
  own.first_frame = robot.first_frame;
  own.max_frames = robot.max_frames;
  std::optional<AtlasTeller> teller;
  PlaceSeeker seeker(atlas, entry);
  Walked walked;
  msg::AtlasRobot found;
  int frames = 0;
  const auto report_map = [&] {
    teller->report(atlas);
    found = robot_in(atlas.state(), robot.name);
  };
  own.on_start = [&](slam::SlamSystem& slam) {
    teller.emplace(robot.name, slam);
    if (turns == nullptr) teller->clock_behind_ns = static_cast<std::int64_t>(number) * kHourNs;
  };
  own.on_features = [&](const camera::SourceFrame& frame, const std::vector<msg::Feature>& features) {
    if (turns != nullptr) turns->wait_for(number);
    if (frames % kReportEvery == 0) seeker.look(frame, features);
  };
  own.on_frame = [&](const slam::SlamOutput& output) {
    if (++frames % kReportEvery == 0) report_map();
    if (found.met && msg::has_pose(output.result.state))
      walked.live.push_back(
          {output.result.stamp_ns, msg::to_isometry(found.T_map_robot) * output.result.T_world_camera});
    if (turns != nullptr) turns->pass_on(number);
  };
  own.on_end = [&](slam::SlamSystem&) {
    if (turns != nullptr) turns->wait_for(number);
    report_map();
    if (turns != nullptr) turns->leave(number);
  };
  const OfflineReport report = run_offline(own);
  entry.ate_alone_m = report.ate_rmse_m;
  entry.live_alone_m = report.online_ate_rmse_m;
  entry.add_ms = 1e3 * eval::summarize(teller->add_s).mean;
  entry.straighten_ms = 1e3 * eval::summarize(teller->straighten_s).mean;
  entry.kilobytes_per_s = 1e-3 * static_cast<double>(teller->bytes_sent) * 30 / frames;
  walked.alone = report.trajectory;
  walked.groundtruth = report.groundtruth;
  walked.first = seeker.first(report.groundtruth);
  return walked;
}

/// The poses of a robot in the joint map: each where it is from the keyframe of that robot that is nearest in time.
eval::Trajectory in_joint_map(const atlas::Atlas& atlas, const std::string& robot, const eval::Trajectory& alone) {
  std::map<std::int64_t, Eigen::Isometry3d> T_map_robot;  // by the stamps of its keyframes
  const auto owners = atlas.owners();
  for (const slam::KeyframeId id : owners.at(robot)) {
    const slam::Keyframe& keyframe = *atlas.map().find_keyframe(id);
    const std::int64_t stamp_ns = keyframe.frame->stamp_ns;
    const auto own = std::ranges::lower_bound(alone, stamp_ns, {}, &eval::StampedPose::stamp_ns);
    if (own != alone.end() && own->stamp_ns == stamp_ns)
      T_map_robot[stamp_ns] = keyframe.T_world_camera * own->T_world_body.inverse();
  }
  eval::Trajectory joint = alone;
  for (eval::StampedPose& pose : joint) {
    auto next = T_map_robot.lower_bound(pose.stamp_ns);
    const bool is_before =
        next != T_map_robot.begin() &&
        (next == T_map_robot.end() || pose.stamp_ns - std::prev(next)->first < next->first - pose.stamp_ns);
    if (is_before) --next;
    pose.T_world_body = next->second * pose.T_world_body;
  }
  return joint;
}

/// How well all that met fit together.
void judge(const atlas::Atlas& atlas, const std::vector<Walked>& walks, TrialResult& result) {
  Pairs all, all_live;
  std::vector<Pairs> joint;
  for (std::size_t i = 0; i < walks.size(); ++i) {
    TrialResult::Robot& entry = result.robots[i];
    const msg::AtlasRobot found = robot_in(atlas.state(), entry.name);
    entry.met = found.met;
    entry.meetings = found.meetings;
    entry.keyframes = found.keyframes;
    joint.emplace_back();
    if (!found.met) continue;
    const eval::Trajectory& truth = walks[i].groundtruth;
    joint.back() = Pairs(eval::ate(in_joint_map(atlas, entry.name, walks[i].alone), truth));
    all.append(joint.back());
    all_live.append(Pairs(eval::ate(walks[i].live, truth)));
  }
  const eval::Alignment alignment = align(all);
  for (std::size_t i = 0; i < walks.size(); ++i) {
    const FirstPose& first = walks[i].first;
    result.robots[i].ate_joint_m = rmse_m(joint[i], alignment);
    if (first.p_truth) result.robots[i].first_pose_error_m = (alignment * first.p_map - *first.p_truth).norm();
  }
  result.ate_joint_m = rmse_m(all, alignment);
  result.live_joint_m = rmse_m(all_live, align(all_live));
}

}  // namespace

TrialResult run_atlas_trial(const std::vector<TrialRobot>& robots, const OfflineOptions& options,
                            const atlas::AtlasConfig& config, bool together) {
  atlas::Atlas atlas(config);
  TrialResult result;
  for (const TrialRobot& robot : robots) result.robots.emplace_back().name = robot.name;
  Turns turns(robots.size());
  std::vector<std::future<Walked>> walking;
  for (std::size_t i = 0; i < robots.size(); ++i)
    walking.push_back(std::async(together ? std::launch::async : std::launch::deferred, [&, i] {
      try {
        return walk(robots[i], i, together ? &turns : nullptr, options, atlas, result.robots[i]);
      } catch (...) {
        turns.leave(i);  // or the others wait for ever
        throw;
      }
    }));
  std::vector<Walked> walks;
  for (std::future<Walked>& walk : walking) walks.push_back(walk.get());
  judge(atlas, walks, result);
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

constexpr int kPerSecond = 2;  ///< keyframes of a robot; the service requests and reports as often

/// A robot that goes along a walk again and again, with a map and landmarks of its own.
class Walker {
 public:
  Walker(const Walk& walk, int number) : walk_(walk), number_(number), name_("robot" + std::to_string(number)) {}
  const std::string& name() const { return name_; }

  msg::MapUpdate announce(int step) const {
    Eigen::Isometry3d T_own_map = Eigen::Isometry3d::Identity();
    T_own_map.translation().x() = number_;
    msg::MapUpdate update;
    update.session_ns = kSessionNs;
    msg::MapKeyframe& entry = update.keyframes.emplace_back();
    entry.keyframe_id = static_cast<std::uint32_t>(step);
    entry.stamp_ns = stamp_ns(step);
    entry.T_world_camera = msg::to_message(T_own_map * walk_.T_map_camera[at(step)]);
    return update;
  }
  msg::KeyframeFeatures features(int step) const {
    msg::KeyframeFeatures features = walk_.features[at(step)];
    features.session_ns = kSessionNs;
    features.keyframe_id = static_cast<std::uint32_t>(step);
    features.stamp_ns = stamp_ns(step);
    const auto round = static_cast<std::uint32_t>(place(step) / walk_.features.size());
    for (msg::KeyframeFeature& feature : features.features)
      if (feature.landmark_id != msg::kNoId) feature.landmark_id += 100'000U * round;
    return features;
  }

 private:
  static constexpr std::int64_t kSessionNs = 1;
  std::size_t place(int step) const { return static_cast<std::size_t>(step) + 3 * static_cast<std::size_t>(number_); }
  std::size_t at(int step) const { return place(step) % walk_.features.size(); }
  std::int64_t stamp_ns(int step) const { return step * (1'000'000'000LL / kPerSecond) + number_; }

  const Walk& walk_;
  int number_;
  std::string name_;
};

/// One worker that what comes waits for; its time is the CPU's. All in s since the start.
class Worker {
 public:
  void work(double comes_s, const std::function<void()>& job) {
    const std::clock_t start = std::clock();
    job();
    const double took_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    cpu_s += took_s;
    free_s = std::max(free_s, comes_s) + took_s;
  }
  double free_s = 0;  ///< from then on
  double cpu_s = 0;
};

}  // namespace

ScaleResult run_scale_trial(const OfflineOptions& source, int robots, int seconds, const atlas::AtlasConfig& config) {
  constexpr double kStep_s = 1.0 / kPerSecond;
  constexpr std::size_t kRequested = 10;
  const Walk walk = walk_once(source);
  std::vector<Walker> walkers;
  for (int robot = 0; robot < robots; ++robot) walkers.emplace_back(walk, robot);
  atlas::Atlas atlas(config);
  Worker worker;
  ScaleResult result;
  std::vector<double> took_ms;
  for (int step = 0; step < seconds * kPerSecond; ++step) {
    std::vector<double> came_s;
    for (const Walker& walker : walkers) {
      const msg::MapUpdate update = walker.announce(step);
      const msg::KeyframeFeatures features = walker.features(step);
      came_s.push_back(kStep_s * (step + static_cast<double>(came_s.size()) / robots));
      worker.work(came_s.back(), [&] {
        atlas.follow(walker.name(), update, update.keyframes.front().stamp_ns);
        atlas.add(walker.name(), features);
      });
    }
    worker.work(kStep_s * (step + 1), [&] { atlas.straighten(); });
    for (const double since_s : came_s) took_ms.push_back(1e3 * (worker.free_s - since_s));
    worker.work(worker.free_s, [&] {
      for (const Walker& walker : walkers) atlas.missing(walker.name(), kRequested);
      result.all_met = std::ranges::all_of(atlas.state().robots, &msg::AtlasRobot::met);
    });
  }
  result.keyframes = took_ms.size();
  result.cpu_s = worker.cpu_s;
  result.p99_ms = eval::percentile(took_ms, 0.99);
  result.longest_ms = *std::ranges::max_element(took_ms);
  result.kept = atlas.map().keyframes().size();
  result.peak_mb = peak_mb();
  return result;
}

}  // namespace rtd::test_support
