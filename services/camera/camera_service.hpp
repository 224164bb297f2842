// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "common/camera/depth_figures.hpp"
#include "common/camera/open/source_factory.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/log.hpp"
#include "common/service/pacer.hpp"
#include "common/service/patience.hpp"
#include "common/service/runtime.hpp"
#include "common/service/topic_source.hpp"
#include "services/camera/core/left_out.hpp"
#include "services/camera/core/read_ahead.hpp"
#include "services/camera/frame_publisher.hpp"

namespace CLI {
class App;
}

namespace rtd::camera {

/// Section `camera` of the configuration.
struct ServiceConfig {
  std::string source = "synthetic:office";
  int frames = 0;
  int jpeg_quality = 90;
  int asap_window = 3;
  int resend_after_ms = 2000;
  double result_timeout_s = 1e-3 * service::kEveryFramePatience.result_ms;
  double start_timeout_s = 45;  ///< a large map takes slam some of it
  double max_gap_s = 1.0;
  std::vector<std::string> wait_for = {"filter", "slam"};
  std::string groundtruth_out;
  std::vector<std::string> sensor_topics;
  int source_id = 0;
  std::string resume_after;

  void bind(auto& binder) {
    binder.field("source", source, source_help()).option("--source");
    binder.field("frames", frames, {0, 1e9}, "play at most this many frames, 0 = all").option("--frames");
    binder.field("jpeg_quality", jpeg_quality, {1, 100}, "of the compressed topic, encoded only while it has readers");
    binder.field("asap_window", asap_window, {1, 3}, "pace asap: frames without a result at a time");
    binder.field("resend_after_ms", resend_after_ms, {10, 60000},
                 "silence after which frames in flight are sent again");
    binder.field("result_timeout_s", result_timeout_s, {0.1, 3600}, "silence after which the run has failed");
    binder.field("start_timeout_s", start_timeout_s, {0, 3600},
                 "longest wait for a running camera, and for the services of wait_for");
    binder.field("max_gap_s", max_gap_s, {0.01, 3600}, "pace realtime: longer pauses between stamps are cut to this");
    binder.field("wait_for", wait_for, "services that must be ready before the first frame, or none")
        .option("--wait-for");
    binder.field("groundtruth_out", groundtruth_out, "file that gets the ground truth in TUM format, empty = none")
        .option("--groundtruth-out");
    binder
        .field("sensor_topics", sensor_topics,
               "topics of a recording that are published with its frames: an IMU, wheels, /tf_static; rtd run fills in "
               "those of --imu, --wheel-odometry and --camera-in-base tf")
        .formerly("camera.beside")
        .option("--sensor-topics,--beside");
    binder
        .field("source_id", source_id, {0, 2147483647},
               "of the frames, by which others know a camera that is started again; 0: a random one")
        .option("--source-id");
    binder
        .field("resume_after", resume_after,
               "SEQ,STAMP_NS,PUBLISHED_NS of the last frame of an earlier process, behind which this one continues; "
               "empty: from the beginning")
        .option("--resume-after");
  }
};

/// rtd-camera: plays a source onto the bus at the requested pace (docs/architecture.md, "Pacing").
class CameraService {
 public:
  static constexpr const char* kName = "camera";
  static constexpr const char* kDescription = "Plays RGB-D frames from a folder or a synthetic scene onto the bus";
  using Config = ServiceConfig;
  static void add_options(CLI::App& app, std::vector<service::GivenOption>& given);

  /// Opens the source, but for a running camera, which run() waits for; throws ConfigError when it cannot be used.
  CameraService(const Config& config, service::Runtime& runtime);
  ~CameraService();

  /// Waits for the others, plays the source, waits for the last result.
  service::ExitCode run();

 private:
  using Results = concurrency::BoundedQueue<std::uint64_t>;
  enum class Outcome { kDone, kStopped, kFailed };

  /// Waits for the first frame of a running camera.
  Outcome open();
  void open_auxiliary();
  /// Once the size of the images is known.
  void open_publisher();
  void report_wait(const std::string& what);
  Outcome wait_for_others();
  /// Goes behind the last frame of an earlier process.
  void resume();
  Outcome play();
  std::vector<std::string> missing() const;
  Outcome play(ReadAhead& frames);
  Outcome handle(SourceFrame frame, ReadAhead& frames);
  /// Carries out decisions that concern frames in flight; kDone when the next frame may go.
  Outcome follow(const service::PaceDecision& decision);
  Outcome drain();
  void drain_by_time();
  void wait(std::int64_t wait_ns);
  void take_results();
  void note(std::uint64_t seq);
  void send(const vision::RgbdImage& image);
  void send_truth(const SourceFrame& frame);
  void resend();
  void log_opened() const;
  /// What the source left out.
  void log_skipped(const ReadItem& item);
  /// Pauses that were cut, and a source slower than its stamps.
  void log_timeline(const service::PaceDecision& decision, std::uint64_t frame) const;
  void note_depth_offset(const SourceFrame& frame);
  void note_depth(const SourceFrame& frame);
  void report_counters();
  void write_groundtruth();
  Outcome fail(const std::string& message);
  service::ExitCode finish(Outcome outcome);
  static constexpr int kReportEvery = 10;  ///< frames
  std::uint64_t late() const { return pacer_.late() + passed_over_; }

  Config config_;
  service::Runtime& runtime_;
  std::shared_ptr<FrameSource> source_;
  bool realtime_;
  service::Pacer pacer_;
  std::shared_ptr<Results> results_;                          ///< seq of every TrackingResult
  std::shared_ptr<concurrency::BoundedQueue<bool>> changes_;  ///< a service became ready or a reader matched
  FramePublisher publisher_;
  bus::Writer<msg::PoseStamped> truth_;
  std::optional<MotionPublisher> motion_;        ///< of sources that have an IMU or wheels
  std::optional<AuxiliaryPublisher> auxiliary_;  ///< of a recording that has them
  /// The last frame that an earlier process of the camera gave: this one continues behind it.
  struct ResumePoint {
    std::uint64_t seq = 0;
    std::int64_t stamp_ns = 0, published_ns = 0;  ///< published_ns: CLOCK_MONOTONIC
  };
  static std::optional<ResumePoint> resume_point_of(const Config& config);
  const std::optional<ResumePoint> resume_;
  const std::shared_ptr<bus::SourceGate> slam_;
  bus::Reader<msg::TrackingResult> tracking_;
  bool one_by_one_ = true;  ///< the next frame after the result of this one, until all in flight have theirs
  std::deque<vision::RgbdImage> in_flight_;  ///< kept for sending again; empty at pace realtime
  SourceCounters counters_, passed_;         ///< passed_: on the way behind the last frame of an earlier process
  LeftOut left_out_;
  DepthOffsets depth_offsets_;
  DepthFigures depth_figures_;
  std::uint64_t frames_in_ = 0, passed_over_ = 0, published_ = 0, refused_ = 0, last_seq_ = 0, newest_result_ = 0;
  bool any_result_ = false;
  std::atomic<bool> playing_{false};
  service::RateLimit skip_log_{std::chrono::seconds(1)}, late_log_{std::chrono::seconds(1)},
      refused_log_{std::chrono::seconds(1)}, wait_log_{std::chrono::seconds(5)};
};

}  // namespace rtd::camera
