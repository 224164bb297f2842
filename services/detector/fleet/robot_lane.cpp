// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/fleet/robot_lane.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <utility>

#include "common/service/camera_frame.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/peer_clocks.hpp"
#include "services/detector/detector_service.hpp"

namespace rtd::detector {
namespace {

/// "gpubox (pid 42)".
std::string name_of(const msg::ServiceStatus& status) {
  const std::string host = msg::word_of(status, service::metric::kHostNamePrefix).substr(0, 64);
  return fmt::format("{} (pid {})", host.empty() ? "another detector" : host, status.pid);
}

Claim claim_of(const msg::ServiceStatus& status) {
  return {status.started_ns, service::find_metric(status, service::metric::kHostId).value_or(0), status.pid};
}

bool serves(const msg::ServiceStatus& status) {
  return status.state != msg::ServiceState::kFinished && status.state != msg::ServiceState::kFailed &&
         !service::find_metric(status, service::metric::kHung);
}

}  // namespace

RobotLane::RobotLane(const bus::Bus& bus, std::string robot, std::chrono::milliseconds stuck_after, OnImage on_image)
    : robot_(std::move(robot)),
      stuck_after_(stuck_after),
      on_image_(std::move(on_image)),
      bus_(bus.of_robot(robot_)),
      detections_(bus_->writer(bus::topics::kDetections)),
      duty_(service::monotonic_ns()),
      statuses_(bus_->reader<msg::ServiceStatus>(
          bus::topics::kStatus,
          [this](const std::shared_ptr<const msg::ServiceStatus>& status) { receive(*status); })) {}

/// Readers end first: their callbacks use the rest.
RobotLane::~RobotLane() {
  statuses_ = {};
  jpegs_ = {};
}

void RobotLane::receive(const msg::ServiceStatus& status) {
  if (status.service != DetectorService::kName) return;
  if (status.pid == getpid() && status.started_ns == started_ns_) return;
  const std::lock_guard lock(duty_mutex_);
  duty_.observe(claim_of(status), name_of(status), serves(status), service::monotonic_ns());
}

void RobotLane::update(const Update& latest) {
  const std::int64_t now_ns = service::monotonic_ns();
  Duty::Role before, role;
  {
    const std::lock_guard lock(duty_mutex_);
    before = duty_.role();
    role = duty_.update({started_ns_, service::PeerClocks::this_host_id(), getpid()}, now_ns);
  }
  if (role == Duty::Role::kServing && !serving()) take_over();
  if (role != Duty::Role::kServing && serving()) step_down();
  if (role == Duty::Role::kStandby && before != role) SPDLOG_INFO("event=standby cause=\"{}\"", description());
  follow_camera(latest.camera_seen, now_ns);
  report(latest, now_ns);
}

void RobotLane::take_over() {
  auto heartbeat = std::make_unique<service::Heartbeat>(*bus_, DetectorService::kName, second_found_,
                                                        service::Heartbeat::SecondInstance::kAllowed);
  heartbeat->watch_progress(stuck_after_);
  const std::lock_guard lock(mutex_);
  started_ns_ = heartbeat->started_ns();
  heartbeat_ = std::move(heartbeat);
  SPDLOG_INFO("event=serves robot=\"{}\"", robot_);
}

/// The heartbeat reports an end, which the other detector and the robot receive.
void RobotLane::step_down() {
  std::unique_ptr<service::Heartbeat> ended;
  const std::lock_guard lock(mutex_);
  started_ns_ = 0;
  ended = std::move(heartbeat_);
}

/// The camera of a host that died stays announced for a while, and one that restarts is gone for a moment.
void RobotLane::follow_camera(bool seen, std::int64_t now_ns) {
  if (seen) camera_seen_ns_ = now_ns;
  const bool there = camera_seen_ns_ != 0 && now_ns - camera_seen_ns_ < kGoneAfterNs;
  gone_ = camera_seen_ns_ != 0 && !there;
  const bool wanted = there && serving();
  if (wanted == static_cast<bool>(jpegs_)) return;
  if (wanted) {
    jpegs_ = bus_->reader<msg::CompressedImage>(
        bus::topics::kColorJpeg,
        [this](std::shared_ptr<const msg::CompressedImage> jpeg) { on_image_(std::move(jpeg)); });
  } else {
    jpegs_ = {};
  }
  reading_ = wanted;
  SPDLOG_INFO("event={} robot=\"{}\"", wanted ? "reads_images" : "reads_no_images", robot_);
}

void RobotLane::report(const Update& latest, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  if (!heartbeat_) return;
  const AnswerSummary summary = stats_.summary(now_ns);
  const std::pair<const char*, double> metrics[] = {{service::metric::kFrames, double(answered_)},
                                                    {service::metric::kFramesDropped, double(latest.dropped)},
                                                    {service::metric::kFramesBroken, double(broken_)},
                                                    {service::metric::kRateHz, summary.rate_hz},
                                                    {service::metric::kLatencyP50Ms, summary.latency_p50_ms},
                                                    {service::metric::kLatencyP99Ms, summary.latency_p99_ms},
                                                    {service::metric::kBatchMean, summary.batch_mean}};
  for (const auto& [metric, value] : metrics) heartbeat_->set_metric(metric, value);
  using State = msg::ServiceState;
  if (!reading_) {
    heartbeat_->set_state(State::kStarting, camera_seen_ns_ == 0 ? "waits for a camera" : "the camera is gone");
  } else if (jpegs_.matched() == 0 || detections_.matched() == 0) {
    heartbeat_->set_state(State::kStarting, "waits for a camera and a filter");
  } else {
    heartbeat_->set_state(answered_ > 0 ? State::kRunning : State::kReady, latest.work);
  }
}

void RobotLane::tick() {
  const std::lock_guard lock(mutex_);
  if (heartbeat_) heartbeat_->tick();
}

void RobotLane::publish(const Answer& answer) {
  if (!serving()) return;
  const std::lock_guard lock(mutex_);
  if (!heartbeat_) return;
  detections_.write(to_message(answer.detections, answer.stamp_ns, service::camera_frame(*heartbeat_, *bus_)));
  stats_.add(answer.arrived_ns, service::monotonic_ns(), answer.batch);
  ++answered_;
}

void RobotLane::count_broken(const std::string& cause) {
  const std::lock_guard lock(mutex_);
  ++broken_;
  if (broken_log_.pass()) SPDLOG_WARN("event=image_skipped robot=\"{}\" total={} cause=\"{}\"", robot_, broken_, cause);
}

std::string RobotLane::name() const {
  return robot_.empty() ? "the robot without a name" : robot_;
}

std::string RobotLane::description() const {
  const std::lock_guard lock(duty_mutex_);
  switch (duty_.role()) {
    case Duty::Role::kListening:
      return "looks for another detector of " + name();
    case Duty::Role::kStandby:
      return fmt::format("standby for {}: {} serves it", name(), duty_.other());
    case Duty::Role::kServing:
      break;
  }
  return reading_ ? "serves " + name() : name() + " is not there";
}

}  // namespace rtd::detector
