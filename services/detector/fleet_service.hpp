// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "common/service/exit_code.hpp"
#include "common/service/runtime.hpp"
#include "common/vision/detection.hpp"
#include "services/detector/core/fleet/stage_timing.hpp"
#include "services/detector/fleet/fleet_arrivals.hpp"
#include "services/detector/fleet/handover.hpp"
#include "services/detector/fleet/robot_finder.hpp"
#include "services/detector/fleet/robot_lane.hpp"
#include "services/detector/fleet/worker_pool.hpp"

namespace rtd::detector {

struct ServiceConfig;

/// How one detector serves several robots.
struct FleetConfig {
  std::set<std::string> robots;  ///< only these; empty: all that are found
  FleetQueueConfig queue;
  int decoders = 1;
  std::chrono::milliseconds stuck_after{1500};  ///< no progress for longer: other detectors take over
};

/// Throws ConfigError for what cannot be combined with several robots, and for names that no robot can have.
FleetConfig fleet_config(const ServiceConfig& config, const service::Runtime& runtime);

/// What computes the boxes of a batch of 8-bit BGR images, of any sizes: one list for each image.
struct Inference {
  std::function<std::vector<std::vector<vision::Detection>>(std::span<const cv::Mat>)> detect;
  std::string device;  ///< for people
};

/// Loads the network. Throws ConfigError when there is none or it is broken.
Inference load_inference(const ServiceConfig& config);

/// One detector for the robots of a domain, by their JPEG images. Robots are found while it runs. The newest image of
/// each robot waits for its turn, batches are decoded by several threads while the network computes the batch before,
/// and the detections go to the topic of the robot. Where another detector serves a robot, this one stands by for it.
class FleetService {
 public:
  /// The process's own heartbeat, on rtd/status: it says whom it serves. Several may run in a domain.
  static constexpr const char* kHeartbeatName = "detector_box";
  static constexpr std::size_t kMostRobots = 64;  ///< others in the domain could make up names without end

  /// Joins the domain once more, to find robots.
  FleetService(const FleetConfig& config, service::Runtime& runtime, Inference inference);
  ~FleetService();
  FleetService(const FleetService&) = delete;
  FleetService& operator=(const FleetService&) = delete;
  service::ExitCode run();

 private:
  using Clock = std::chrono::steady_clock;
  using Lanes = std::map<std::string, std::shared_ptr<RobotLane>>;
  struct Image {
    std::string robot;
    std::int64_t stamp_ns = 0, arrived_ns = 0;
  };
  /// What goes to the network, image by image.
  struct Batch {
    std::vector<Image> images;
    std::vector<cv::Mat> pixels;
  };

  void prepare_batches();
  Batch decode(const std::vector<FleetArrivals::Queue::Taken>& taken);
  Clock::time_point decode_at(Clock::time_point began, std::size_t images);
  void detect_until_stopped();
  void detect(const Batch& batch);
  void look_after_robots();
  void update_lanes();
  void open_lane(const std::string& robot);
  void report(const Lanes& lanes);
  Lanes lanes() const;
  std::shared_ptr<RobotLane> lane(const std::string& robot) const;
  void close_lanes();

  const FleetConfig config_;
  service::Runtime& runtime_;
  const Inference inference_;
  const RobotLane::Options lane_options_;
  std::shared_ptr<FleetArrivals> arrivals_;
  std::shared_ptr<Handover<Batch>> handover_;
  WorkerPool decoders_;
  mutable std::mutex lanes_mutex_;
  Lanes lanes_;
  std::set<std::string> refused_;  ///< one log line each
  std::mutex timing_mutex_;
  StageTiming timing_;
  std::uint64_t batches_ = 0, images_ = 0;
  service::RateLimit failure_log_{std::chrono::seconds(1)};
  RobotFinder finder_;
};

}  // namespace rtd::detector
