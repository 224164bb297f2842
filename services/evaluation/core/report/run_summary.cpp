// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/report/run_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/camera/open/source_factory.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/geometry/pose_list.hpp"
#include "common/msg/transform_eigen.hpp"
#include "services/evaluation/core/trajectory/trajectory_error.hpp"

namespace rtd::eval {
namespace {

constexpr int kFrames = 60, kFrameStep = 15, kPixelStep = 8;

void add_depths(const vision::RgbdImage& image, std::vector<double>& depths_m) {
  for (int row = 0; row < image.depth.rows; row += kPixelStep) {
    for (int column = 0; column < image.depth.cols; column += kPixelStep) {
      const std::uint16_t depth = image.depth.at<std::uint16_t>(row, column);
      if (depth > 0) depths_m.push_back(depth * image.depth_scale_m);
    }
  }
}

/// How far away the background of a source is: the upper quartile of the depths in some of its first frames. Only of
/// TUM folders and synthetic scenes; none where no frame can be read.
std::optional<double> scene_depth_m(const std::string& source_uri) {
  const bool folder = camera::is_of_kind(source_uri, camera::SourceKind::kFolder);
  if (!folder && !run_record::is_synthetic(source_uri)) return std::nullopt;
  std::vector<double> depths_m;
  try {
    const auto source = camera::make_source(source_uri);
    for (int i = 0; i < kFrames; ++i) {
      const auto frame = source->next();
      if (!frame) break;
      if (i % kFrameStep == 0) add_depths(frame->image, depths_m);
    }
  } catch (const std::exception&) {  // the source is no longer there: the depth is not known
  }
  if (depths_m.empty()) return std::nullopt;
  return percentile(depths_m, 0.75);
}

constexpr std::array<const char*, msg::kStageFilterTotal + 1> kFilterStageNames{
    "filter.wait_detections", "filter.extract", "filter.masks", "filter.ego_motion",
    "filter.depth_check",     "filter.fuse",    "filter.total"};
constexpr std::array<const char*, msg::kStageSlamTotal + 1> kSlamStageNames{
    "slam.match", "slam.local_map", "slam.pose", "slam.keyframe", "slam.mapping", "slam.total"};

constexpr float kRanMs = 0.01F;  // a shorter time only means that the stage had nothing to do

bool is_tracked(const run_record::FrameRecord& frame) {
  return msg::is_measured(frame.tracking.state);
}

std::vector<double> latencies_ms(const Run& run) {
  std::vector<double> latencies;
  for (const run_record::FrameRecord& frame : run.frames) {
    if (const auto latency = latency_ms(frame)) latencies.push_back(*latency);
  }
  return latencies;
}

/// Summary of the finite values.
TimeSummary summarize_times(const std::vector<double>& times_ms) {
  std::vector<double> finite;
  std::ranges::copy_if(times_ms, std::back_inserter(finite), [](double t) { return std::isfinite(t); });
  const Statistics s = summarize(finite);
  return {finite.size(), s.mean, percentile(finite, 0.5), percentile(finite, 0.99), s.max};
}

template <std::size_t N, typename TimesOf>
void append_stages(const Run& run, const std::array<const char*, N>& names, TimesOf times_of,
                   std::vector<StageSummary>& stages) {
  for (std::size_t stage = 0; stage < N; ++stage) {
    std::vector<double> times_ms;
    for (const run_record::FrameRecord& frame : run.frames) {
      if (const float ms = times_of(frame)[stage]; ms >= kRanMs) times_ms.push_back(ms);
    }
    stages.push_back({names[stage], summarize_times(times_ms)});
  }
}

std::vector<LostFrames> lost_frames(const Run& run) {
  std::vector<LostFrames> lost;
  if (run.frames.empty()) return lost;
  const std::int64_t start_ns = run.frames.front().tracking.stamp_ns;
  const auto add = [&](std::uint64_t first_seq, std::uint64_t last_seq, std::int64_t stamp_ns) {
    if (!lost.empty() && lost.back().last_seq + 1 == first_seq) {
      lost.back().last_seq = last_seq;
    } else {
      lost.push_back({first_seq, last_seq, static_cast<double>(stamp_ns - start_ns) * 1e-9});
    }
  };
  std::uint64_t next_seq = run.frames.front().tracking.seq;
  std::int64_t before_ns = start_ns;
  for (const run_record::FrameRecord& frame : run.frames) {
    const auto& tracking = frame.tracking;
    if (tracking.seq > next_seq) add(next_seq, tracking.seq - 1, before_ns);
    if (!is_tracked(frame)) add(tracking.seq, tracking.seq, tracking.stamp_ns);
    next_seq = tracking.seq + 1;
    before_ns = tracking.stamp_ns;
  }
  return lost;
}

double mean_of(const Run& run, const auto& count_of) {
  std::vector<double> counts;
  for (const run_record::FrameRecord& frame : run.frames) counts.push_back(count_of(frame));
  return summarize(counts).mean;
}

Trajectory read_or_note(const std::string& what, const std::string& path, std::vector<std::string>& notes) {
  if (path.empty()) {
    notes.push_back("no " + what);
    return {};
  }
  try {
    geometry::PoseList list = geometry::read_pose_list(std::filesystem::path(path));
    for (auto* lines : {&list.notes, &list.damages}) std::ranges::move(*lines, std::back_inserter(notes));
    return std::move(list.poses);
  } catch (const TrajectoryError& error) {
    notes.push_back(what + " unusable: " + error.what());
    return {};
  }
}

std::optional<Evaluation> evaluate_or_note(const std::string& what, const Trajectory& estimate,
                                           const Trajectory& groundtruth, std::vector<std::string>& notes) {
  if (estimate.empty() || groundtruth.empty()) return std::nullopt;
  Evaluation evaluation = evaluate(estimate, groundtruth);
  if (evaluation.ate.error_m.count == 0) {
    notes.push_back(what + ": no pose lies within 0.02 s of the ground truth");
    return std::nullopt;
  }
  if (evaluation.ate.error_m.count < kFewestAtePoses) {
    notes.push_back(fmt::format("{}: only {} poses have a true one, and any {} fit each other: no ATE", what,
                                evaluation.ate.error_m.count, kFewestAtePoses - 1));
    return std::nullopt;
  }
  if (evaluation.offset) notes.push_back(what + ": " + explain(*evaluation.offset));
  if (!evaluation.ate.alignment.unique) {
    notes.push_back(what + ": poses lie on one line or point, so the alignment is one of many and the ATE optimistic");
  }
  return evaluation;
}

/// A slam that was restarted writes the trajectory of its last life.
void note_lost_part(const Run& run, RunSummary& summary) {
  const auto slam = run.processes.find("slam");
  const Trajectory published = online_trajectory(run);
  if (slam == run.processes.end() || slam->second.restarts == 0 || summary.estimate.empty() || published.empty())
    return;
  const std::int64_t first_ns = summary.estimate.front().stamp_ns;
  const auto before = std::ranges::count_if(published, [&](const StampedPose& p) { return p.stamp_ns < first_ns; });
  if (before == 0) return;
  summary.notes.push_back(fmt::format(
      "slam was restarted: trajectory.txt has only the last {} poses, from {:.1f} s on; the {} before are in "
      "trajectory_online.txt",
      summary.estimate.size(), static_cast<double>(first_ns - published.front().stamp_ns) * 1e-9, before));
}

std::optional<Integrity> integrity_of(const Run& run, const RunSummary& summary) {
  if (run.frames.empty() || !summary.online_trajectory) return std::nullopt;
  std::vector<PublishedPose> published;
  for (const run_record::FrameRecord& frame : run.frames) published.push_back(published_pose(frame.tracking));
  return judge_integrity(published, camera_truth(summary.groundtruth, summary.online_trajectory->offset));
}

}  // namespace

const Drift* drift_of(const RunSummary& summary) {
  if (summary.online_trajectory) return &summary.online_trajectory->drift;
  return summary.final_trajectory ? &summary.final_trajectory->drift : nullptr;
}

std::optional<double> latency_ms(const run_record::FrameRecord& frame) {
  const auto& tracking = frame.tracking;
  if (!is_tracked(frame) || tracking.published_ns <= 0 || tracking.finished_ns < tracking.published_ns)
    return std::nullopt;
  return static_cast<double>(tracking.finished_ns - tracking.published_ns) * 1e-6;
}

Trajectory online_trajectory(const Run& run) {
  Trajectory trajectory;
  for (const run_record::FrameRecord& frame : run.frames) {
    const auto& tracking = frame.tracking;
    if (!is_tracked(frame)) continue;
    const Eigen::Isometry3d T_world_camera = msg::to_isometry(tracking.T_world_camera);
    if (!T_world_camera.matrix().allFinite()) continue;
    if (!trajectory.empty() && tracking.stamp_ns <= trajectory.back().stamp_ns) continue;
    trajectory.push_back({tracking.stamp_ns, T_world_camera});
  }
  return trajectory;
}

RunSummary summarize_run(const Run& run) {
  RunSummary summary;
  summary.frames = run_record::frame_use(run);
  summary.coverage = summary.frames.coverage();
  if (run.frames_in > 0 && run.duration_s > 0) summary.fps = static_cast<double>(run.frames_in) / run.duration_s;
  summary.latency_ms = summarize_times(latencies_ms(run));
  append_stages(
      run, kFilterStageNames, [](const run_record::FrameRecord& f) -> auto& { return f.filter_stage_ms; },
      summary.stages);
  append_stages(
      run, kSlamStageNames, [](const run_record::FrameRecord& f) -> auto& { return f.tracking.stage_ms; },
      summary.stages);
  summary.lost = lost_frames(run);
  summary.kept_mean = mean_of(run, [](const run_record::FrameRecord& f) { return f.tracking.features_static; });
  summary.removed_mean = mean_of(run, [](const run_record::FrameRecord& f) { return f.tracking.features_removed; });
  if (!run.frames.empty()) {
    summary.keyframes = run.frames.back().tracking.keyframes;
    summary.landmarks = run.frames.back().tracking.landmarks;
  }
  summary.groundtruth = read_or_note("ground truth", run.groundtruth_path, summary.notes);
  summary.estimate = read_or_note("trajectory", run.trajectory_path, summary.notes);
  summary.final_trajectory = evaluate_or_note("trajectory", summary.estimate, summary.groundtruth, summary.notes);
  summary.online_trajectory =
      evaluate_or_note("published poses", online_trajectory(run), summary.groundtruth, summary.notes);
  note_lost_part(run, summary);
  if (auto unit = other_unit(summary.estimate, summary.groundtruth)) summary.notes.push_back(std::move(*unit));
  summary.integrity = integrity_of(run, summary);
  const Drift* drift = drift_of(summary);
  if (drift != nullptr && drift->nearly_constant()) summary.scene_depth_m = scene_depth_m(run.source);
  return summary;
}

}  // namespace rtd::eval
