// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// What a CameraService notes and reports of its source, and where it continues after an earlier process.
#include <sstream>

#include "common/io/atomic_file.hpp"
#include "common/service/metric_names.hpp"
#include "services/camera/camera_service.hpp"

namespace rtd::camera {
namespace {

constexpr std::size_t kOffsetsToLog = 30;  // frames
constexpr std::uint64_t kDepthToLog = 11;  // frames, of which two are looked at

}  // namespace

std::optional<CameraService::ResumePoint> CameraService::resume_point_of(const Config& config) {
  if (config.resume_after.empty()) return std::nullopt;
  std::istringstream fields(config.resume_after);
  ResumePoint point;
  char first = 0, second = 0;
  fields >> point.seq >> first >> point.stamp_ns >> second >> point.published_ns;
  if (fields.fail() || !fields.eof() || first != ',' || second != ',')
    throw service::ConfigError("camera.resume_after: '" + config.resume_after + "' is not SEQ,STAMP_NS,PUBLISHED_NS");
  return point;
}

void CameraService::log_opened() const {
  const SourceInfo& info = source_->info();
  const auto& camera = info.camera.parameters();
  SPDLOG_INFO("event=source_opened uri={} frames={} width={} height={} fx={} fps={}", info.uri, info.frames,
              camera.width, camera.height, camera.fx, info.fps);
  for (const std::string& note : info.notes) SPDLOG_INFO("event=source_note text=\"{}\"", note);
  for (const std::string& remark : info.remarks) SPDLOG_WARN("event=source_remark cause=\"{}\"", remark);
}

void CameraService::log_skipped(const ReadItem& item) {
  for (const SkippedInput& skipped : item.skipped) {
    if (!skip_log_.pass()) continue;
    SPDLOG_WARN("event=input_skipped reason={} total={} detail=\"{}\"", to_string(skipped.reason),
                item.counters.skipped_total(), skipped.detail);
  }
}

void CameraService::log_timeline(const service::PaceDecision& decision, std::uint64_t frame) const {
  if (decision.cut_gap_ns > 0) {
    SPDLOG_WARN("event=gap_cut frame={} cut_s={:.3f} played_s={:g}", frame,
                static_cast<double>(decision.cut_gap_ns) * 1e-9, config_.max_gap_s);
  }
  if (decision.shifted_ns > 0) {
    SPDLOG_WARN("event=timeline_shifted frame={} by_s={:.3f} cause=\"the source is slower than its stamps\"", frame,
                static_cast<double>(decision.shifted_ns) * 1e-9);
  }
}

void CameraService::note_depth_offset(const SourceFrame& frame) {
  if (!frame.depth_after_color_ns) return;
  depth_offsets_.add(*frame.depth_after_color_ns);
  if (frames_in_ != kOffsetsToLog) return;
  SPDLOG_INFO("event=depth_offset median_ms={:.1f} frames={}", *depth_offsets_.median_ms(), depth_offsets_.size());
}

/// Of every tenth frame; said once, and again in heartbeats and at the end.
void CameraService::note_depth(const SourceFrame& frame) {
  if (frames_in_ % kReportEvery == 1) depth_figures_.add(frame.image.depth, frame.image.depth_scale_m);
  const std::optional<double> median_m = depth_figures_.median_m();
  if (frames_in_ != kDepthToLog || !median_m) return;
  SPDLOG_INFO("event=depth_seen median_m={:.2f} holes={:.3f}", *median_m, depth_figures_.hole_share());
  const std::string doubt = depth_figures_.doubt(source_->info().depth_unit_given);
  if (!doubt.empty()) SPDLOG_WARN("event=depth_unit_doubtful cause=\"{}\"", doubt);
}

void CameraService::report_counters() {
  const auto set = [this](const char* name, std::uint64_t value) {
    runtime_.heartbeat.set_metric(name, static_cast<double>(value));
  };
  set(service::metric::kFramesIn, frames_in_);
  set(service::metric::kFramesPublished, published_);
  set(service::metric::kFramesLate, late());
  set(service::metric::kFramesSkipped, counters_.skipped_total() - passed_.skipped_total());
  set(service::metric::kFramesWithoutDepth, counters_.frames_without_depth);
  set(service::metric::kFramesRefused, refused_);
  for (const auto& [name, count] : left_out_.metrics(frames_in_)) set(name.c_str(), count);
  set(service::metric::kReconnects, counters_.reconnects);
  set(service::metric::kJpegsDropped, publisher_.jpegs().dropped());
  set(service::metric::kResends, pacer_.resends());
  if (const auto offset_ms = depth_offsets_.median_ms())
    runtime_.heartbeat.set_metric(service::metric::kDepthOffsetMs, *offset_ms);
  if (const auto median_m = depth_figures_.median_m()) {
    runtime_.heartbeat.set_metric(service::metric::kDepthMedianM, *median_m);
    runtime_.heartbeat.set_metric(service::metric::kDepthHoles, depth_figures_.hole_share());
  }
}

void CameraService::write_groundtruth() {
  if (config_.groundtruth_out.empty()) return;
  const geometry::Trajectory poses = source_->groundtruth();
  if (poses.empty()) {
    SPDLOG_INFO("event=no_groundtruth uri={}", source_->info().uri);
    return;
  }
  try {
    io::write_file(
        config_.groundtruth_out,
        [&](std::ostream& file) { geometry::write_tum_trajectory(file, poses, geometry::TumStyle::kGroundtruth); },
        {.named_by = io::NamedBy::kOperator});
  } catch (const io::IoError& error) {
    SPDLOG_ERROR("event=groundtruth_not_written cause=\"{}\"", error.what());
  }
}

}  // namespace rtd::camera
