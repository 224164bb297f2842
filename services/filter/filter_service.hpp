// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "common/bus/commands.hpp"
#include "common/bus/frame_topics.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "common/inertial/motion_feed.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/load_step.hpp"
#include "common/service/log.hpp"
#include "common/service/recent_messages.hpp"
#include "common/service/runtime.hpp"
#include "common/service/topic_source.hpp"
#include "services/filter/config.hpp"
#include "services/filter/core/dynamic_filter.hpp"
#include "services/filter/core/load/load_watch.hpp"
#include "services/filter/inboxes.hpp"
#include "services/filter/movers_publisher.hpp"

namespace rtd::filter {

/// Frames and detections in, features with their static probability out. Realtime pace: never waits for the detector;
/// at most 2 frames wait, the oldest is dropped and counted; features of the next frame are found in a thread of its
/// own while a frame is judged; sheds load while poses come late (common/service/load_step.hpp). Asap and lockstep:
/// every frame, with the detections, and the masks if they come, of exactly that frame; lockstep also after slam's
/// result for the frame before, so that every run is the same.
class FilterService {
 public:
  static constexpr const char* kName = "filter";
  static constexpr const char* kDescription = "Extracts ORB features and finds out which of them lie on moving objects";
  static constexpr std::uint32_t kShmSegmentMib = bus::kSmallSegmentMib;
  using Config = ServiceConfig;

  FilterService(const Config& config, service::Runtime& runtime);
  ~FilterService();
  FilterService(const FilterService&) = delete;
  FilterService& operator=(const FilterService&) = delete;
  service::ExitCode run();

 private:
  /// A frame, and how often another camera had been followed before it.
  struct Arrival {
    std::shared_ptr<const msg::FrameView> frame;
    std::uint64_t camera_changes = 0;
  };
  using Frames = concurrency::BoundedQueue<Arrival>;
  /// A frame and, where another thread finds them, its features.
  struct Work {
    Arrival arrival;
    std::optional<Extraction> extraction;
    std::exception_ptr failure;  ///< of that thread
  };
  using Prepared = concurrency::BoundedQueue<Work>;

  static constexpr std::int64_t kPatienceNs = 1'500'000'000;  ///< for the successor of a service that is gone

  void prepare_frames();
  std::optional<Work> next_frame();
  void process(Work work);
  int first_load_step() const;
  bool sheds_load() const;
  const service::LoadStep& follow_load_step();
  void notice_standstill();
  void watch_load(const msg::TrackingResult& result);
  bool accept(const Arrival& arrival);
  void publish_no_features(const msg::FrameView& frame, const std::string& cause);
  void forget_views(const msg::FrameView& frame, const char* cause);
  bool detector_gone() const;
  bool detector_there() const;
  void follow_camera(const Arrival& arrival);
  Extraction extract(std::uint64_t seq, const vision::RgbdImage& image);
  void fill_next(const msg::FrameView& frame, const FilterResult& result, msg::DetectionUse use);
  void follow_time(const msg::FrameView& frame);
  void trace(std::int64_t waiting_since_ns, std::int64_t judging_since_ns);
  void apply_slam_feedback();
  std::int64_t wait_for_slam(std::uint64_t seq);
  void take_imu(std::int64_t stamp_ns);
  DetectorUpdate collect_detections(const msg::FrameView& frame);
  void wait_for_detections(const msg::FrameView& frame);
  /// By the detector's heartbeat, or because a program writes them: the heartbeat of a replay does not say it.
  bool masks_come() const { return mask_reader_ && (detector_masks_ || mask_reader_.matched() > 0); }
  void read_masks();
  msg::DetectionUse use_of(const DetectorUpdate& detector, const FilterResult& result, std::int64_t stamp_ns) const;
  void watch_detector();
  void count(const FilterResult& result);
  void report_state();
  bus::CommandAnswer set_mode(const std::string& name);

  const Config config_;
  service::Runtime& runtime_;
  DynamicFilter filter_;
  MoversPublisher movers_;
  std::shared_ptr<Frames> frames_;
  std::shared_ptr<Prepared> prepared_ = std::make_shared<Prepared>(1, concurrency::Overflow::kBlock);
  LoadWatch load_;
  std::int64_t looked_ns_ = 0, ran_ns_ = 0;  ///< of notice_standstill(): when, and processor time until then
  std::shared_ptr<DetectionInbox> detections_ = std::make_shared<DetectionInbox>();
  std::shared_ptr<SlamFeedback> feedback_ = std::make_shared<SlamFeedback>();
  std::optional<inertial::MotionFeed> imu_;
  bus::Writer<msg::FeatureFrame> writer_;
  bus::Writer<msg::Image> mask_writer_;
  const std::shared_ptr<bus::SourceGate> camera_, detector_, slam_;
  bus::FrameReader frame_reader_;
  bus::Reader<msg::Image> mask_reader_;  ///< before the other reader: who writes both is matched here first
  bus::Reader<msg::Detection2DArray> detection_reader_;
  bus::Reader<msg::TrackingResult> tracking_reader_;
  bus::Reader<msg::KeyframeEvent> keyframe_reader_;

  service::RecentMessages<msg::FeatureFrame> messages_;
  const msg::FeatureFrame* message_ = nullptr;  ///< the newest; null until there is one
  std::uint64_t published_ = 0, defective_ = 0, unpaired_ = 0, camera_changes_ = 0, camera_id_ = 0;
  bool detector_seen_ = false, detector_gone_ = false, slam_seen_ = false;
  std::atomic<bool> detector_masks_{false};                  ///< its heartbeat says that it sends masks
  std::atomic<bool> detector_ready_{false};                  ///< its heartbeat said once that it is; after the masks
  std::atomic<std::int64_t> detector_alive_ns_{0};           ///< CLOCK_MONOTONIC of its last heartbeat, 0 = ended
  std::array<double, msg::kFilterStages> total_stage_ms_{};  ///< of all published frames
  service::RateLimit defect_log_{std::chrono::seconds(1)}, wait_log_{std::chrono::seconds(1)};
  service::RateLimit misfit_log_{std::chrono::seconds(10)};
  service::RateLimit broken_masks_log_{std::chrono::seconds(10)};  ///< of a bus thread
  std::optional<bus::CommandServer> commands_;
  std::thread preparing_;  // these two last: they use the others
};

}  // namespace rtd::filter
