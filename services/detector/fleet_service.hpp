// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
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
#include "services/detector/fleet/fleet_config.hpp"
#include "services/detector/fleet/handover.hpp"
#include "services/detector/fleet/robot_finder.hpp"
#include "services/detector/fleet/robot_lane.hpp"
#include "services/detector/fleet/worker_pool.hpp"

namespace rtd::detector {

/// One detector for the robots of a domain, by their JPEG images. Robots are found while it runs. The newest image of
/// each robot waits for its turn, batches are decoded by several threads while the network computes the batch before,
/// and the detections go to the topic of the robot. Where another detector serves a robot, this one stands by for it.
class FleetService {
 public:
  /// The process's own heartbeat, on rtd/status: it says whom it serves. Several may run in a domain.
  static constexpr const char* kHeartbeatName = "detector_box";

  /// Joins the domain once more, to find robots.
  FleetService(const FleetConfig& config, service::Runtime& runtime, Inference inference);
  ~FleetService();
  FleetService(const FleetService&) = delete;
  FleetService& operator=(const FleetService&) = delete;
  service::ExitCode run();

 private:
  using Clock = std::chrono::steady_clock;
  using Boxes = std::vector<std::vector<vision::Detection>>;
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
  Boxes infer(std::span<const cv::Mat> images);
  std::string device() const;
  void look_after_robots();
  void update_lanes();
  void open_lane(const std::string& robot);
  bool make_room();
  void log_refusal(const std::string& robot, const std::string& cause);
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
  std::set<std::string> denied_;   ///< robots whose topics the bus refuses
  std::set<std::string> refused_;  ///< robots that are not served: one log line each
  mutable std::mutex inference_mutex_;
  StageTiming timing_;
  std::string device_;
  int failures_ = 0;  ///< of the engine, in a row
  std::uint64_t batches_ = 0, images_ = 0;
  service::RateLimit failure_log_{std::chrono::seconds(1)}, robot_log_{std::chrono::seconds(1)};
  RobotFinder finder_;
};

}  // namespace rtd::detector
