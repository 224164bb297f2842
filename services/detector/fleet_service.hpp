// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "common/bus/raw_bus.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/runtime.hpp"
#include "services/detector/fleet/fleet_config.hpp"
#include "services/detector/fleet/fleet_pipeline.hpp"
#include "services/detector/fleet/robot_lane.hpp"

namespace rtd::detector {

/// Finds the robots of a domain by their cameras, which announce JPEG images. Thread-safe.
class RobotFinder {
 public:
  /// Joins the domain. Throws BusError.
  explicit RobotFinder(const bus::BusOptions& options);
  ~RobotFinder();
  RobotFinder(const RobotFinder&) = delete;
  RobotFinder& operator=(const RobotFinder&) = delete;

  /// Robots with a camera now; "" is the one without a name.
  std::set<std::string> robots() const;

 private:
  void note(const bus::TopicWriter& writer, bus::WriterChange change);

  mutable std::mutex mutex_;
  std::map<std::string, std::set<bus::WriterId>> cameras_;
  std::shared_ptr<bus::RawBus> bus_;
};

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
  using Lanes = std::map<std::string, std::shared_ptr<RobotLane>>;

  FleetPipeline::Outputs outputs();
  void update_robots();
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
  const std::shared_ptr<FleetPipeline> pipeline_;
  mutable std::mutex lanes_mutex_;
  Lanes lanes_;
  std::set<std::string> denied_;   ///< robots whose topics the bus refuses
  std::set<std::string> refused_;  ///< robots that are not served: one log line each
  service::RateLimit robot_log_{std::chrono::seconds(1)};
  RobotFinder finder_;
};

}  // namespace rtd::detector
