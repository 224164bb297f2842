// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/fleet_service.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "common/bus/backend.hpp"
#include "common/bus/robot.hpp"
#include "common/bus/topics.hpp"
#include "common/service/log.hpp"
#include "common/service/metric_names.hpp"

namespace rtd::detector {
namespace {

constexpr std::chrono::milliseconds kUpdatePeriod{50};  ///< robots come and go, others take over

}  // namespace

RobotFinder::RobotFinder(const bus::BusOptions& options) : bus_(bus::connect_raw(options)) {
  bus_->watch([this](const bus::TopicWriter& writer, bus::WriterChange change) { note(writer, change); });
}

RobotFinder::~RobotFinder() {
  bus_->watch({});
}

void RobotFinder::note(const bus::TopicWriter& writer, bus::WriterChange change) {
  const bus::RobotTopic name = bus::split_robot(writer.topic.name);
  if (name.topic != bus::topics::kColorJpeg.name) return;
  if (writer.topic.type != bus::dds_type_name(bus::MessageTraits<msg::CompressedImage>::kId)) return;
  const std::lock_guard lock(mutex_);
  std::set<bus::WriterId>& cameras = cameras_[name.robot];
  if (change == bus::WriterChange::kGone) {
    cameras.erase(writer.id);
  } else {
    cameras.insert(writer.id);
  }
  if (cameras.empty()) cameras_.erase(name.robot);
}

std::set<std::string> RobotFinder::robots() const {
  const std::lock_guard lock(mutex_);
  std::set<std::string> names;
  for (const auto& [robot, cameras] : cameras_) names.insert(robot);
  return names;
}

FleetService::FleetService(const FleetConfig& config, service::Runtime& runtime, Inference inference)
    : config_(config),
      runtime_(runtime),
      pipeline_(std::make_shared<FleetPipeline>(config, std::move(inference), outputs())),
      finder_(runtime.bus_options) {
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
