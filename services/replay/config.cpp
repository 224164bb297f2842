// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/config.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/service/config.hpp"

namespace rtd::replay {
namespace {

void require(const char* name, double value, double max) {
  if (std::isfinite(value) && value >= 0 && value <= max) return;
  throw service::ConfigError(fmt::format("{} {}: give a number from 0 to {:g}", name, value, max));
}

}  // namespace

void validate(const ServiceConfig& config) {
  if (config.file.empty()) throw service::ConfigError("name a recording: rtd replay FILE (replay.file)");
  require("--rate", config.rate, ServiceConfig::kHighestRate);
  require("--start-offset", config.start_offset_s, ServiceConfig::kLongestS);
  require("--duration", config.duration_s, ServiceConfig::kLongestS);
  require("--clock", config.clock_hz, ServiceConfig::kFastestClockHz);
  require("--wait-readers", config.wait_readers_s, 3600);
  require("--read-ahead", config.read_ahead_mb, ServiceConfig::kMostReadAheadMb);
}

int window_of(const ServiceConfig& config, service::Pace pace) {
  if (pace == service::Pace::kAsap) return config.asap_window;
  return pace == service::Pace::kLockstep || !config.lockstep.empty() ? 1 : 0;
}

}  // namespace rtd::replay
