// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "common/concurrency/bounded_queue.hpp"
#include "common/inertial/motion_feed.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/log.hpp"
#include "common/service/recent_messages.hpp"
#include "common/service/runtime.hpp"
#include "common/service/topic_source.hpp"
#include "services/slam/atlas_client.hpp"
#include "services/slam/camera_tree.hpp"
#include "services/slam/config.hpp"
#include "services/slam/core/slam_system.hpp"
#include "services/slam/keyframe_sender.hpp"
#include "services/slam/map_file.hpp"
#include "services/slam/map_keeper.hpp"
#include "services/slam/map_publisher.hpp"
#include "services/slam/slam_commands.hpp"
#include "services/slam/slam_publisher.hpp"

namespace rtd::slam {

/// Features in, poses out. Every feature frame is answered by one TrackingResult, after the keyframe events that belong
/// to it. Realtime pace: at most 4 frames wait, the oldest is dropped and counted; asap and lockstep: none is lost.
/// Mapping runs in this thread at pace lockstep (same input, same map), else in its own.
class SlamService {
 public:
  static constexpr const char* kName = "slam";
  static constexpr const char* kDescription = "Finds the camera's pose and maps the static world from features";
  static constexpr std::uint32_t kShmSegmentMib = bus::kSmallSegmentMib;
  using Config = ServiceConfig;

  SlamService(const Config& config, service::Runtime& runtime);
  ~SlamService();
  SlamService(const SlamService&) = delete;
  SlamService& operator=(const SlamService&) = delete;
  /// Runs until stop is requested, then writes the files of --out.
  service::ExitCode run();

 private:
  using Arrivals = concurrency::BoundedQueue<std::shared_ptr<const msg::FeatureFrame>>;

  void load_map();
  std::string take_map(MapContents contents);
  void forget_map();
  /// False when the camera is not that of the map the service was started with. One taken by command is given up.
  bool check_camera(const msg::FeatureFrame& frame);
  bool answer_again(const msg::FeatureFrame& frame);
  void answer(const msg::FeatureFrame& frame);
  void take_motion(const msg::FeatureFrame& frame);
  void count_motion();
  void trace(std::int64_t started_ns);
  void count(const SlamOutput& output);
  void log(const SlamOutput& output, msg::TrackingState previous);
  void log_gravity(const UpFound& up) const;
  double input_gone_after_s() const;
  void watch_input(bool arrived);
  void report_state();
  std::string trouble() const;
  service::ExitCode finish();
  bool write_files();

  const Config config_;
  service::Runtime& runtime_;
  SlamSystem slam_;
  MapCameras map_cameras_;  ///< of the loaded map
  bool map_by_command_ = false;
  std::string refused_map_;  ///< why the map taken by command was given up, until the next one or a reset
  CameraTree camera_tree_;
  SlamPublisher publisher_;
  MapPublisher map_publisher_;
  KeyframeSender keyframe_sender_;
  std::optional<AtlasClient> atlas_;            ///< not at pace lockstep: its answers come when they come
  std::optional<inertial::MotionFeed> motion_;  ///< IMU and wheels
  std::shared_ptr<Arrivals> arrivals_;
  const std::shared_ptr<bus::SourceGate> filter_;
  bus::Reader<msg::FeatureFrame> features_;
  std::atomic<bool> source_ended_{false};  ///< as the camera reports
  SlamCounters counters_;
  MapKeeper map_keeper_;  ///< ends before the system that it reads
  msg::TrackingResult last_result_{};
  service::RecentMessages<msg::TrackingResult> results_;
  TrustMonitor trust_monitor_;
  PoseTrust trust_;  ///< of the last result
  std::string last_problem_;
  std::int64_t last_arrival_ns_ = 0, last_diagnostics_ns_ = 0;
  bool readout_logged_ = false;
  double frame_period_s_ = 0;  ///< of the camera, from the stamps of the last two frames
  bool input_gone_ = false;
  std::uint64_t dropped_logged_ = 0;
  service::RateLimit problem_log_{std::chrono::seconds(1)}, invalid_log_{std::chrono::seconds(1)},
      dropped_log_{std::chrono::seconds(1)}, motion_log_{std::chrono::seconds(30)};
  std::shared_ptr<const msg::FeatureFrame> last_frame_;
  std::optional<SlamCommands> commands_;  // last: it uses the others
};

}  // namespace rtd::slam
