// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/fleet_service.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "common/bus/backend.hpp"
#include "common/bus/robot.hpp"
#include "common/bus/topics.hpp"
#include "common/service/camera_frame.hpp"
#include "common/service/log.hpp"
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

namespace {

constexpr std::chrono::milliseconds kUpdatePeriod{50};  ///< robots come and go, others take over

}  // namespace

FleetService::FleetService(const FleetConfig& config, service::Runtime& runtime, Inference inference)
    : config_(config),
      runtime_(runtime),
      pipeline_(std::make_shared<FleetPipeline>(config, std::move(inference), outputs())),
      finder_(runtime.bus_options, bus::topics::kColorJpeg) {
  runtime.heartbeat.watch_progress(config.stuck_after);
  runtime.stop.on_stop([pipeline = pipeline_] { pipeline->close(); });
}

FleetService::~FleetService() {
  close_lanes();
}

FleetPipeline::Outputs FleetService::outputs() {
  return {[this](const std::string& robot, const Answer& answer) {
            if (const auto served = lane(robot)) served->publish(answer);
          },
          [this](const std::string& robot, const std::string& cause) {
            if (const auto served = lane(robot)) served->count_broken(cause);
          },
          [this] {
            runtime_.heartbeat.tick();
            for (const auto& [robot, lane] : lanes()) lane->tick();
          }};
}

/// An engine that fails every time ends the service: another one takes over or, begun again, finds it working.
service::ExitCode FleetService::run() {
  FleetPipeline::End end = FleetPipeline::End::kClosed;
  {
    const std::jthread robots([this] { update_robots(); });
    end = pipeline_->run();
    runtime_.stop.request_stop();
  }
  close_lanes();
  SPDLOG_INFO("event=summary images={} batches={}", pipeline_->images(), pipeline_->batches());
  return end == FleetPipeline::End::kClosed ? service::kOk : service::kRunFailed;
}

/// Next to the pipeline: opening and closing topics takes time.
void FleetService::update_robots() {
  for (const std::string& robot : config_.robots) open_lane(robot);
  do {
    update_lanes();
  } while (!runtime_.stop.wait_for(kUpdatePeriod));
}

void FleetService::update_lanes() {
  const std::set<std::string> found = finder_.robots();
  if (config_.robots.empty())
    for (const std::string& robot : found) open_lane(robot);
  const Lanes all = lanes();
  const auto served = std::ranges::count_if(all, [](const auto& entry) { return entry.second->reading(); });
  const std::string work = fmt::format("{}, {} robot{}", pipeline_->device(), served, served == 1 ? "" : "s");
  for (const auto& [robot, lane] : all) {
    const bool was_reading = lane->reading();
    try {
      lane->update({found.contains(robot), pipeline_->dropped(robot), work});
    } catch (const bus::BusError& error) {
      if (robot_log_.pass()) SPDLOG_ERROR("event=robot_failed robot=\"{}\" cause=\"{}\"", robot, error.what());
    }
    if (was_reading && !lane->reading()) pipeline_->remove(robot);
  }
  report(all);
}

/// A lane stays when its robot leaves: the status says so, and the robot may come back.
void FleetService::open_lane(const std::string& robot) {
  if (lane(robot) || denied_.contains(robot)) return;
  if (!make_room()) return log_refusal(robot, fmt::format("{} robots are served already", config_.most_robots));
  try {
    auto opened =
        std::make_shared<RobotLane>(runtime_.bus, robot, config_.stuck_after,
                                    [pipeline = pipeline_, robot](std::shared_ptr<const msg::CompressedImage> jpeg) {
                                      pipeline->put(robot, std::move(jpeg));
                                    });
    SPDLOG_INFO("event=robot_found robot=\"{}\"", robot);
    const std::lock_guard lock(lanes_mutex_);
    lanes_[robot] = std::move(opened);
  } catch (const bus::BusError& error) {  // keys that do not know this robot
    denied_.insert(robot);
    log_refusal(robot, error.what());
  }
}

/// The lane of a robot that has left is closed when its place is needed.
bool FleetService::make_room() {
  const Lanes all = lanes();
  if (all.size() < config_.most_robots) return true;
  const auto unused = std::ranges::find_if(all, [](const auto& entry) { return entry.second->gone(); });
  if (unused == all.end() || !config_.robots.empty()) return false;
  const std::lock_guard lock(lanes_mutex_);
  lanes_.erase(unused->first);
  return true;
}

void FleetService::log_refusal(const std::string& robot, const std::string& cause) {
  constexpr std::size_t kMaxLogged = 100;  // others in the domain could make up names without end
  if (refused_.size() >= kMaxLogged || !refused_.insert(robot).second) return;
  SPDLOG_ERROR("event=robot_refused robot=\"{}\" cause=\"{}\"", robot, cause);
}

void FleetService::report(const Lanes& lanes) {
  std::vector<std::string> parts;
  double serving = 0, reading = 0;
  for (const auto& [robot, lane] : lanes) {
    parts.push_back(lane->description());
    serving += lane->serving() ? 1 : 0;
    reading += lane->reading() ? 1 : 0;
  }
  runtime_.heartbeat.set_metric(service::metric::kRobots, static_cast<double>(lanes.size()));
  runtime_.heartbeat.set_metric(service::metric::kRobotsServed, serving);
  runtime_.heartbeat.set_metric(service::metric::kRobotsRead, reading);
  runtime_.heartbeat.set_state(reading > 0 ? msg::ServiceState::kRunning : msg::ServiceState::kReady,
                               parts.empty() ? "no robot found" : fmt::format("{}", fmt::join(parts, "; ")));
}

FleetService::Lanes FleetService::lanes() const {
  const std::lock_guard lock(lanes_mutex_);
  return lanes_;
}

std::shared_ptr<RobotLane> FleetService::lane(const std::string& robot) const {
  const std::lock_guard lock(lanes_mutex_);
  const auto found = lanes_.find(robot);
  return found == lanes_.end() ? nullptr : found->second;
}

/// Side by side: each waits until its end is received, by which another detector takes over.
void FleetService::close_lanes() {
  Lanes closing;
  {
    const std::lock_guard lock(lanes_mutex_);
    closing.swap(lanes_);
  }
  std::vector<std::jthread> threads;
  for (auto& [robot, lane] : closing) threads.emplace_back([&lane] { lane.reset(); });
}

}  // namespace rtd::detector
