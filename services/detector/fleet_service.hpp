// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "common/bus/robot_finder.hpp"
#include "common/msg/ros.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/log.hpp"
#include "common/service/runtime.hpp"
#include "services/detector/core/fleet/duty.hpp"
#include "services/detector/fleet_config.hpp"
#include "services/detector/fleet_pipeline.hpp"

namespace rtd::detector {

/// One robot of several: its JPEG images in, its detections out, and its heartbeat of a service "detector", which says
/// how it is served. While another detector serves the robot, it reads no images and sends no heartbeat (Duty).
/// Thread-safe, but for update(), which belongs to one thread.
class RobotLane {
 public:
  using OnImage = std::function<void(std::shared_ptr<const msg::CompressedImage>)>;
  /// What the lane receives at each update().
  struct Update {
    bool camera_seen = false;   ///< a camera of this robot is in the domain
    std::uint64_t dropped = 0;  ///< images that newer ones have replaced
    std::string work;           ///< what computes the boxes and for how many robots, for people
  };

  /// `on_image` runs on a thread of the bus.
  RobotLane(const bus::Bus& bus, std::string robot, std::chrono::milliseconds stuck_after, OnImage on_image);
  ~RobotLane();
  RobotLane(const RobotLane&) = delete;
  RobotLane& operator=(const RobotLane&) = delete;

  /// Takes over, stands by, opens or closes the reader of images, and reports. To be called often.
  void update(const Update& latest);
  /// The thread that computes the boxes continues.
  void tick();
  /// Publishes, if the lane still serves the robot.
  void publish(const Answer& answer);
  /// An image could not be used.
  void count_broken(const std::string& cause);

  bool serving() const { return started_ns_ != 0; }
  /// Whether images may come: it serves a robot whose camera is there, or was until a moment ago.
  bool reading() const { return reading_; }
  /// Whether its camera was there and has left.
  bool gone() const { return gone_; }
  /// "anna", "standby for anna: gpubox (pid 42) serves it": for people.
  std::string description() const;

  static constexpr std::int64_t kGoneAfterNs = 5'000'000'000;  ///< without a camera for so long: images are not read

 private:
  void receive(const msg::ServiceStatus& status);
  void take_over();
  void step_down();
  void follow_camera(bool seen, std::int64_t now_ns);
  void report(const Update& latest, std::int64_t now_ns);
  std::string name() const;

  const std::string robot_;
  const std::chrono::milliseconds stuck_after_;
  const OnImage on_image_;
  const std::shared_ptr<bus::Bus> bus_;
  bus::Writer<msg::Detection2DArray> detections_;

  mutable std::mutex duty_mutex_;
  Duty duty_;
  std::atomic<std::int64_t> started_ns_{0};  ///< of the own heartbeat; 0: does not serve
  std::atomic<bool> reading_{false}, gone_{false};

  std::mutex mutex_;                 ///< guards what follows
  service::StopToken second_found_;  ///< the heartbeat's; Duty decides
  std::unique_ptr<service::Heartbeat> heartbeat_;
  AnswerStats stats_;
  std::uint64_t answered_ = 0, broken_ = 0;
  service::RateLimit broken_log_{std::chrono::seconds(1)};

  bus::Reader<msg::CompressedImage> jpegs_;  ///< of update()
  std::int64_t camera_seen_ns_ = 0;          ///< last time; 0: never
  bus::Reader<msg::ServiceStatus> statuses_;
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
  bus::RobotFinder finder_;  ///< by their cameras, which announce JPEG images
};

}  // namespace rtd::detector
