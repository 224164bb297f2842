// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/fleet_config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>

#include "common/bus/robot.hpp"
#include "common/service/config.hpp"
#include "services/detector/core/engine.hpp"
#include "services/detector/detector_service.hpp"

namespace rtd::detector {
namespace {

constexpr std::chrono::milliseconds kStuckAfter{1500}, kStuckAfterPerImage{250};
constexpr unsigned kUsualDecoders = 4;
constexpr const char* kAll = "all";

void require_combinable(const ServiceConfig& config, const service::Runtime& runtime) {
  const auto refuse = [](bool wrong, const char* what) {
    if (wrong) throw service::ConfigError(std::string("detector.robots (--robots): ") + what);
  };
  refuse(runtime.pace != service::Pace::kRealtime,
         "several robots are served at pace realtime; run one detector for each robot at asap or lockstep");
  refuse(config.input == "frame", "raw frames never leave their host: leave detector.input at auto or jpeg");
  refuse(config.masks.use == "on", "they get boxes alone: leave detector.masks (--masks) at auto or off");
  refuse(config.max_rate_hz > 0, "detector.max_rate_hz (--max-rate) is for one robot: leave it at 0");
  refuse(!runtime.bus.robot().empty(), "--robot names the one robot of a detector: leave one of the two out");
}

}  // namespace

int usual_decoders() {
  return static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, kUsualDecoders));
}

FleetConfig fleet_config(const ServiceConfig& config, const service::Runtime& runtime) {
  require_combinable(config, runtime);
  FleetConfig fleet;
  fleet.robots = {config.robots.begin(), config.robots.end()};
  if (fleet.robots.erase(kAll) > 0 && !fleet.robots.empty())
    throw service::ConfigError("detector.robots (--robots): 'all' is given alone, not with names");
  for (const std::string& robot : fleet.robots) {
    if (bus::is_robot_name(robot)) continue;
    throw service::ConfigError(fmt::format(
        "detector.robots (--robots): '{}' cannot be a robot's name: use letters, digits and single underscores, a "
        "letter first; 'all' also serves a robot without a name",
        robot));
  }
  fleet.queue.batch = static_cast<std::size_t>(config.batch);
  fleet.decoders = config.decoders > 0 ? config.decoders : usual_decoders();
  fleet.stuck_after = kStuckAfter + config.batch * kStuckAfterPerImage;
  return fleet;
}

Inference load_inference(const ServiceConfig& config) {
  const auto guard = load_network([&] { return std::make_shared<EngineGuard>(core_config(config), config.batch); });
  const Detector& loaded = guard->detector();
  const InputSize input = loaded.input_size();
  SPDLOG_INFO("event=model_loaded file={} input={}x{} threads={} device=\"{}\"", loaded.config().model_path,
              input.width_px, input.height_px, config.core.threads, loaded.device());
  if (!guard->no_batch().empty()) SPDLOG_WARN("event=no_batch cause=\"{}\"", guard->no_batch());
  const auto log = std::make_shared<EngineLog>(config.core.engine);
  log->report(*guard);
  return {[guard, log](std::span<const cv::Mat> images) {
            auto found = guard->detect_batch(images);
            log->report(*guard);
            return found;
          },
          [guard] { return "computes on " + guard->device(); }};
}

}  // namespace rtd::detector
