// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/map_scale.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "services/slam/core/map/trajectory.hpp"
#include "services/slam/core/tracking/tracker.hpp"

namespace rtd::test_support {
namespace {

using slam::FramePtr;

/// Tracker and mapper in one thread: SlamSystem at pace lockstep, with the choice to hurry the mapper.
class Walk {
 public:
  explicit Walk(const MapScaleOptions& options)
      : options_(options), world_(options.world), mapper_(options.slam), tracker_(options.slam, options.now_ns) {}

  void start() {
    slam::KeyframeProposal first;
    first.frame = slam::make_frame(*next_message(), options_.slam.sensor).frame;
    first.landmarks.assign(first.frame->features.size(), slam::kNoLandmark);
    const FramePtr frame = first.frame;
    insert(first);
    tracker_.initialize(frame, snapshot_);
  }

  void step() {
    const auto message = next_message();
    const std::int64_t allocations = count_allocations(), start_ns = options_.now_ns();
    const FramePtr frame = slam::make_frame(*message, options_.slam.sensor).frame;
    const slam::TrackOutcome outcome = tracker_.track(frame, snapshot_);
    note(costs_.tracking, start_ns);
    costs_.allocations.push_back(count_allocations() - allocations);
    ++report_.frames;
    if (outcome.state != msg::TrackingState::kOk) {
      ++report_.lost_frames;
      return;
    }
    frames_.push_back({frame->seq, frame->stamp_ns, outcome.tracked.reference, outcome.tracked.T_reference_camera});
    measure_motion(outcome.tracked.T_world_camera);
    if (wants_keyframe(tracker_.keyframe_situation(*snapshot_, true), options_.slam.keyframe)) {
      insert(tracker_.propose_keyframe());
    } else if (outcome.tracked.reference != snapshot_->keyframes.front().id) {
      take_snapshot(outcome.tracked.reference);
    }
  }

  bool reached(std::size_t keyframes) const {
    return (options_.path == WalkPath::kRoom ? insertions_ : mapper_.map().keyframes().size()) >= keyframes;
  }
  void hurry(bool late) { late_ = late; }
  std::size_t insertions() const { return insertions_; }
  /// What was measured since the last call.
  MapScaleCosts take_costs() { return std::exchange(costs_, {}); }

  MapScaleReport finish() {
    const slam::Map& map = mapper_.map();
    std::int64_t start_ns = options_.now_ns();
    compose_trajectory(map, frames_);
    report_.trajectory_ns = options_.now_ns() - start_ns;
    start_ns = options_.now_ns();
    map_points(map);
    report_.map_points_ns = options_.now_ns() - start_ns;
    report_.insertions = insertions_;
    report_.keyframes = map.keyframes().size();
    report_.landmarks = map.landmark_count();
    for (const auto& [id, keyframe] : map.keyframes()) {
      report_.features += keyframe.landmarks.size();
      report_.observations += static_cast<std::size_t>(std::count_if(
          keyframe.landmarks.begin(), keyframe.landmarks.end(), [](auto l) { return l != slam::kNoLandmark; }));
    }
    report_.broken_invariant = map.check_invariants();
    return std::move(report_);
  }

 private:
  std::unique_ptr<msg::FeatureFrame> next_message() {
    T_world_camera_ = (options_.path == WalkPath::kRoom ? room_pose : aisle_pose)(seq_);
    return world_.view(seq_++, T_world_camera_);
  }

  std::int64_t count_allocations() const { return options_.allocations ? options_.allocations() : 0; }

  void insert(const slam::KeyframeProposal& proposal) {
    const std::int64_t start_ns = options_.now_ns();
    newest_ = mapper_.insert(proposal, [this] { return late_; });
    note(costs_.insertion, start_ns);
    mapper_.take_changes();
    ++insertions_;
    take_snapshot(newest_);
    if (options_.on_keyframe) options_.on_keyframe(insertions_);
  }

  void take_snapshot(slam::KeyframeId centre) {
    const std::int64_t start_ns = options_.now_ns();
    snapshot_ = mapper_.local_map(centre);
    note(costs_.snapshot, start_ns);
  }

  void note(std::vector<std::int64_t>& costs_ns, std::int64_t start_ns) const {
    costs_ns.push_back(options_.now_ns() - start_ns);
  }

  void measure_motion(const Eigen::Isometry3d& T_map_camera) {
    if (last_true_ && frames_.size() > 1 && frames_.back().seq == frames_[frames_.size() - 2].seq + 1) {
      const Eigen::Vector3d true_m = (last_true_->inverse() * T_world_camera_).translation();
      const Eigen::Vector3d found_m = (last_found_.inverse() * T_map_camera).translation();
      report_.max_error_m = std::max(report_.max_error_m, (true_m - found_m).norm());
    }
    last_true_ = T_world_camera_;
    last_found_ = T_map_camera;
  }

  const MapScaleOptions& options_;
  WalkWorld world_;
  slam::Mapper mapper_;
  slam::Tracker tracker_;
  slam::LocalMapPtr snapshot_;
  slam::KeyframeId newest_ = slam::kNoKeyframe;
  std::uint64_t seq_ = 0;
  std::size_t insertions_ = 0;
  bool late_ = false;
  Eigen::Isometry3d T_world_camera_ = Eigen::Isometry3d::Identity();
  std::optional<Eigen::Isometry3d> last_true_;
  Eigen::Isometry3d last_found_ = Eigen::Isometry3d::Identity();
  std::vector<slam::FrameRecord> frames_;
  MapScaleCosts costs_;
  MapScaleReport report_;
};

}  // namespace

MapScaleReport run_map_scale(const MapScaleOptions& options) {
  constexpr std::size_t kSmall = 100;
  Walk large(options);
  large.start();
  while (!large.reached(options.keyframes)) {
    const std::size_t done = large.insertions();
    large.hurry(done > options.full_mapping && done + options.full_mapping < options.keyframes);
    large.step();
  }
  large.hurry(false);
  MapScaleOptions small_options = options;
  small_options.on_keyframe = {};
  Walk small(small_options);
  small.start();
  while (small.insertions() < kSmall) small.step();
  large.take_costs();
  small.take_costs();
  for (std::size_t i = 0; i < options.compared_frames; ++i) {
    small.step();
    large.step();
  }
  const MapScaleCosts large_costs = large.take_costs();
  MapScaleReport report = large.finish();
  report.small = small.take_costs();
  report.large = large_costs;
  return report;
}

std::int64_t median(std::vector<std::int64_t> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace rtd::test_support
