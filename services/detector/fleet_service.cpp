// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/fleet_service.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <exception>
#include <opencv2/imgcodecs.hpp>
#include <thread>
#include <utility>

#include "common/service/log.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/vision/jpeg_size.hpp"

namespace rtd::detector {
namespace {

constexpr std::chrono::milliseconds kLookAfter{50};  ///< robots come and go, others take over
constexpr int kMostFailures = 20;                    // batches in a row
constexpr std::int64_t kMostPixels = 3840 * 2160;

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

/// Empty when they are broken, or so many that decoding them would cost the other robots time and memory.
cv::Mat pixels_of(const msg::CompressedImage& jpeg) {
  const cv::Size size = vision::jpeg_size(jpeg.data);
  if (size.empty() || std::int64_t{size.width} * size.height > kMostPixels) return {};
  try {
    return cv::imdecode(jpeg.data, cv::IMREAD_COLOR);
  } catch (const cv::Exception&) {  // data from outside never ends the process
    return {};
  }
}

}  // namespace

FleetService::FleetService(const FleetConfig& config, service::Runtime& runtime, Inference inference)
    : config_(config),
      runtime_(runtime),
      inference_(std::move(inference)),
      lane_options_{host_name(), config.stuck_after},
      arrivals_(std::make_shared<FleetArrivals>(config.queue)),
      handover_(std::make_shared<Handover<Batch>>()),
      decoders_(config.decoders),
      device_(inference_.device()),
      finder_(runtime.bus_options) {
  runtime.heartbeat.watch_progress(config.stuck_after);
  runtime.stop.on_stop([arrivals = arrivals_, handover = handover_] {
    arrivals->close();
    handover->close();
  });
}

FleetService::~FleetService() {
  close_lanes();
}

service::ExitCode FleetService::run() {
  {
    const std::jthread robots([this] { look_after_robots(); }), decoding([this] { prepare_batches(); });
    detect_until_stopped();
  }
  close_lanes();
  SPDLOG_INFO("event=summary images={} batches={}", images_, batches_);
  return failures_ < kMostFailures ? service::kOk : service::kRunFailed;
}

/// The first stage: takes the newest images and decodes them when the network is about to be free.
void FleetService::prepare_batches() {
  std::size_t before = 0;  // images of the batch that the network has now
  while (const auto began = handover_->wait_free()) {
    handover_->wait_wanted(decode_at(*began, before));
    const auto taken = arrivals_->take();
    if (taken.empty()) return;
    const std::int64_t started_ns = service::monotonic_ns();
    Batch batch = decode(taken);
    {
      const std::lock_guard lock(inference_mutex_);
      timing_.decoded(service::monotonic_ns() - started_ns);
    }
    if (batch.images.empty()) continue;
    before = batch.images.size();
    handover_->put(std::move(batch));
  }
}

FleetService::Clock::time_point FleetService::decode_at(Clock::time_point began, std::size_t images) {
  const std::lock_guard lock(inference_mutex_);
  return began + timing_.delay(images);
}

FleetService::Batch FleetService::decode(const std::vector<FleetArrivals::Queue::Taken>& taken) {
  std::vector<cv::Mat> decoded(taken.size());
  decoders_.for_each(taken.size(), [&](std::size_t i) { decoded[i] = pixels_of(*taken[i].image); });
  Batch batch;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (decoded[i].empty()) {
      if (const auto broken = lane(taken[i].robot)) broken->count_broken("not a JPEG image of at most 3840x2160 px");
      continue;
    }
    batch.images.push_back({taken[i].robot, msg::to_ns(taken[i].image->header.stamp), taken[i].arrived_ns});
    batch.pixels.push_back(std::move(decoded[i]));
  }
  return batch;
}

/// The second stage.
void FleetService::detect_until_stopped() {
  while (!runtime_.stop.stop_requested()) {
    runtime_.heartbeat.tick();
    for (const auto& [robot, lane] : lanes()) lane->tick();
    if (const std::optional<Batch> batch = handover_->take_for(kLookAfter)) detect(*batch);
  }
}

void FleetService::detect(const Batch& batch) {
  const std::size_t count = batch.images.size();
  Boxes found = infer(batch.pixels);
  ++batches_;
  images_ += count;
  for (std::size_t i = 0; i < count; ++i) {
    const Image& image = batch.images[i];
    const auto served = lane(image.robot);
    if (!served) continue;
    if (i < found.size()) {
      served->publish({image.stamp_ns, image.arrived_ns, count, std::move(found[i])});
    } else {
      served->count_broken("the network failed");
    }
  }
}

/// Nothing when the engine fails, which may be for once: the next images come. An engine that fails every time, such as
/// that of a GPU that is gone, ends the service: another one takes over or, begun again, finds it working.
FleetService::Boxes FleetService::infer(std::span<const cv::Mat> images) {
  const std::int64_t started_ns = service::monotonic_ns();
  Boxes found;
  try {
    found = inference_.detect(images);
    failures_ = 0;
  } catch (const std::exception& error) {
    if (failure_log_.pass()) SPDLOG_ERROR("event=inference_failed images={} cause=\"{}\"", images.size(), error.what());
    if (++failures_ == kMostFailures) runtime_.stop.request_stop();
  }
  const std::lock_guard lock(inference_mutex_);
  timing_.inferred(images.size(), service::monotonic_ns() - started_ns);
  device_ = inference_.device();
  return found;
}

std::string FleetService::device() const {
  const std::lock_guard lock(inference_mutex_);
  return device_;
}

/// Beside the stages: opening and closing topics takes time.
void FleetService::look_after_robots() {
  for (const std::string& robot : config_.robots) open_lane(robot);
  do {
    update_lanes();
  } while (!runtime_.stop.wait_for(kLookAfter));
}

void FleetService::update_lanes() {
  const std::set<std::string> found = finder_.robots();
  if (config_.robots.empty())
    for (const std::string& robot : found) open_lane(robot);
  const Lanes all = lanes();
  const auto served = std::ranges::count_if(all, [](const auto& entry) { return entry.second->reading(); });
  const std::string work = fmt::format("{}, {} robot{}", device(), served, served == 1 ? "" : "s");
  for (const auto& [robot, lane] : all) {
    const bool was_reading = lane->reading();
    try {
      lane->update({found.contains(robot), arrivals_->dropped(robot), work});
    } catch (const bus::BusError& error) {
      if (robot_log_.pass()) SPDLOG_ERROR("event=robot_failed robot=\"{}\" cause=\"{}\"", robot, error.what());
    }
    if (was_reading && !lane->reading()) arrivals_->remove(robot);
  }
  report(all);
}

/// A lane stays when its robot leaves: the status says so, and the robot may come back.
void FleetService::open_lane(const std::string& robot) {
  if (lane(robot) || denied_.contains(robot)) return;
  if (!make_room()) return log_refusal(robot, fmt::format("{} robots are served already", config_.most_robots));
  try {
    auto opened =
        std::make_shared<RobotLane>(runtime_.bus, robot, lane_options_,
                                    [arrivals = arrivals_, robot](std::shared_ptr<const msg::CompressedImage> jpeg) {
                                      arrivals->put(robot, std::move(jpeg));
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
  constexpr std::size_t kMostLogged = 100;  // others in the domain could make up names without end
  if (refused_.size() >= kMostLogged || !refused_.insert(robot).second) return;
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
  runtime_.heartbeat.set_metric("robots", static_cast<double>(lanes.size()));
  runtime_.heartbeat.set_metric("robots_served", serving);
  runtime_.heartbeat.set_metric("robots_read", reading);
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

/// Side by side: each waits for its end to be heard, by which another detector takes over.
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
