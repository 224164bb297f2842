// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/features.hpp"
#include "common/msg/tracking.hpp"
#include "services/evaluation/core/removal/removal_quality.hpp"

namespace rtd::launcher {

/// What one run told about one frame: joined from rtd/features and rtd/tracking by seq.
struct FrameRecord {
  msg::TrackingResult tracking{};
  std::array<float, msg::kFilterStages> filter_stage_ms{};
  msg::DetectionUse detection_use = msg::DetectionUse::kNone;
  std::uint32_t objects = 0;
};

/// One frame kept for the report: its picture and the features drawn on it.
struct SampleFrame {
  std::uint64_t seq = 0;
  std::vector<std::uint8_t> jpeg;
  std::vector<msg::Feature> features;
};

struct ProcessUsage {
  double cpu_s = 0;  ///< user + system
  double peak_rss_mb = 0;
  int restarts = 0;
};

/// How far the clock of a service's host is ahead of the others' (common/service/peer_clocks.hpp).
struct HostClock {
  std::string service;
  double offset_ms = 0, round_trip_ms = 0;
};

/// Removed features against the true moving pixels, over a run and without its first second: until then there is
/// little to compare with.
struct RunRemoval {
  std::size_t frames = 0;  ///< whose true moving pixels are known
  eval::RemovalQuality all, settled;
};

/// Everything that `rtd run` observed, before it becomes report.json and report.html.
struct RunRecord {
  std::string source, pace, filter_mode, dds, detector;  ///< as given; detector: model name or "off (reason)"
  std::string groundtruth_path;                          ///< TUM format; empty = none
  std::string trajectory_path;                           ///< trajectory.txt written by slam (final poses)
  std::string static_map_path;                           ///< static_map.ply written by dense; empty = none
  std::uint64_t static_map_points = 0;
  std::uint64_t frames_in = 0;          ///< frames the source delivered
  std::uint64_t frames_dropped = 0;     ///< frames in without a TrackingResult
  std::map<std::string, double> drops;  ///< by place, e.g. "camera.late", "filter.queue"
  std::vector<FrameRecord> frames;      ///< ordered by seq
  std::vector<SampleFrame> samples;
  std::map<std::string, ProcessUsage> processes;
  std::vector<HostClock> clocks;    ///< of services on other hosts
  std::vector<std::string> events;  ///< restarts, degraded modes, warnings, in order
  double duration_s = 0;
  std::optional<RunRemoval> removal;  ///< of sources that know what moves
};

}  // namespace rtd::launcher
