// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/msg/features.hpp"
#include "common/msg/tracking.hpp"
#include "common/vision/detection.hpp"

namespace rtd::run_record {

/// What filter and slam published about one frame.
struct FrameRecord {
  msg::TrackingResult tracking{};
  std::array<float, msg::kFilterStages> filter_stage_ms{};
};

/// Calls visit(name, value) with what a report needs of a frame: the columns of the frame table, named once for all who
/// write and read them. `frame`: FrameRecord, const or not.
void for_each_column(auto& frame, const auto& visit) {
  auto& tracking = frame.tracking;
  visit("seq", tracking.seq);
  visit("stamp_ns", tracking.stamp_ns);
  visit("published_ns", tracking.published_ns);
  visit("finished_ns", tracking.finished_ns);
  visit("state", tracking.state);
  visit("translation_m", tracking.T_world_camera.translation_m);
  visit("rotation_xyzw", tracking.T_world_camera.rotation_xyzw);
  visit("inliers", tracking.inliers);
  visit("features_static", tracking.features_static);
  visit("features_removed", tracking.features_removed);
  visit("keyframes", tracking.keyframes);
  visit("landmarks", tracking.landmarks);
  visit("map_id", tracking.map_id);
  visit("slam_stage_ms", tracking.stage_ms);
  visit("filter_stage_ms", frame.filter_stage_ms);
}

/// A feature as the report needs it: where it is in the camera's own image, and what the filter decided.
struct JudgedFeature {
  float u_raw_px = 0, v_raw_px = 0;
  bool removed = false;
};
std::vector<JudgedFeature> judged(std::span<const msg::Feature> features);

/// The features of one frame, to be compared with the true moving pixels.
struct JudgedFrame {
  std::int64_t stamp_ns = 0;
  std::vector<JudgedFeature> features;
};

/// A feature with depth that the filter kept: where it is in the camera's own image, and in the camera's frame.
struct SeenPoint {
  float u_raw_px = 0, v_raw_px = 0;
  std::array<float, 3> p_camera_m{};
};
std::vector<SeenPoint> seen(const msg::FeatureFrame& frame);

/// One frame kept for the report: its image and the features drawn on it.
struct SampleFrame {
  std::uint64_t seq = 0;
  std::vector<std::uint8_t> jpeg;
  std::vector<JudgedFeature> features;
  vision::PersonMasks masks;  ///< the pixels of people; empty where no masks were sent
  std::vector<SeenPoint> points = {};
};

struct ProcessUsage {
  double cpu_s = 0;  ///< user + system
  double peak_rss_mb = 0;
  int restarts = 0;
  int deaths = 0;
  std::string died = {};  ///< how, the last time: "died: killed by signal 9 (SIGKILL)"
};

/// How far the clock of a service's host is ahead of the others' (common/service/peer_clocks.hpp).
struct HostClock {
  std::string service;
  double offset_ms = 0, round_trip_ms = 0;
};

/// Everything that `rtd run` observed. It travels to `rtd-eval` as run.json (services/evaluation/README.md).
struct RunRecord {
  std::string version;                                   ///< of rtd
  std::string source, pace, filter_mode, dds, detector;  ///< as given; detector: model name or "off (reason)"
  bool interrupted = false;                              ///< Ctrl-C ended the run
  bool z_up = false;                                     ///< of the map: that of a robot with a base; else y is down
  double duration_s = 0;                                 ///< from the first frame to the last pose
  std::uint64_t frames_in = 0;                           ///< frames the source delivered
  std::uint64_t frames_left_out = 0;                     ///< frames that it had and could not deliver
  std::uint64_t frames_not_played = 0;                   ///< frames that it has and the run did not come to
  std::uint64_t frames_out_of_range = 0;                 ///< delivered, but without a depth that slam may use
  std::uint64_t frames_dropped = 0;                      ///< frames in without a TrackingResult
  std::map<std::string, double> drops;                   ///< by place, e.g. "camera.late", "filter.queue"
  std::map<std::string, double> left_out;                ///< by reason (camera::SkipReason): what the source left out
  double depth_median_m = 0;                             ///< of the measured pixels; 0 = unknown
  double depth_holes = 0;                                ///< share of the pixels without a measurement
  std::map<std::string, ProcessUsage> processes;
  std::vector<HostClock> clocks;    ///< of services on other hosts
  std::vector<std::string> events;  ///< restarts, degraded modes, warnings, in order
  std::vector<FrameRecord> frames;  ///< ordered by seq
  std::vector<SampleFrame> samples;
  std::vector<JudgedFrame> judged_frames;  ///< in order of time; empty unless has_true_masks(source)
};

/// How many frames of a source a run has used. Everything that is said about a run counts by these.
struct FrameUse {
  std::uint64_t given = 0;      ///< the source has them, whether it could deliver them and the run came to them or not
  std::uint64_t used = 0;       ///< slam got them, with a depth that it may use, and answered
  std::uint64_t with_pose = 0;  ///< a measured one: ok, doubtful or odometry

  /// Frames with pose / frames given, in [0, 1]; NaN without frames.
  double coverage() const;
  /// No more than half of the frames were used: whatever the poses are worth, they are not those of this source.
  bool too_few() const { return 2 * used <= given && used < given; }
  /// "40 given, 38 used, 37 with pose".
  std::string text() const;
};
FrameUse frame_use(const RunRecord& record);

/// "camera died: killed by signal 9 (SIGKILL) (2 times)": one line for each of these services that died, all if none is
/// named. Everything that is said about deaths has these words.
std::vector<std::string> deaths(const RunRecord& record, const std::vector<std::string>& services = {});

/// Whether the source knows which pixels move: a synthetic scene, or a TUM folder with mask/.
bool has_true_masks(const std::string& source_uri);
/// The mask folder of a source "tum:FOLDER" or "folder:FOLDER"; empty for other sources.
std::filesystem::path mask_folder(const std::string& source_uri);
bool is_synthetic(const std::string& source_uri);

/// RFC 4648 base64.
std::string to_base64(const std::vector<std::uint8_t>& bytes);

/// Values as they lie in memory, in base64.
template <class T>
std::string packed(const std::vector<T>& values) {
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(values.data());
  return to_base64({bytes, bytes + values.size() * sizeof(T)});
}

/// The bytes of a base64 text with padding. Throws std::invalid_argument when it is not one.
std::vector<std::uint8_t> from_base64(std::string_view text);

/// run.json cannot be written or read; what() names the file and the cause.
class RunFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Of a frame, only what the report needs is written: no covariance. Throws RunFileError.
void write_run_json(const RunRecord& record, const std::filesystem::path& file);
RunRecord read_run_json(const std::filesystem::path& file);

}  // namespace rtd::run_record
