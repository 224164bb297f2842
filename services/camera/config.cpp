// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/config.hpp"

#include <cstdint>

namespace rtd::camera {
namespace {

constexpr double kNsPerSecond = 1e9;

std::int64_t seconds_to_ns(double seconds) {
  return static_cast<std::int64_t>(seconds * kNsPerSecond);
}

int window_of(const ServiceConfig& config, service::Pace pace) {
  switch (pace) {
    case service::Pace::kRealtime:
      return 0;
    case service::Pace::kAsap:
      return config.asap_window;
    case service::Pace::kLockstep:
      return 1;
  }
  return 1;
}

}  // namespace

service::PacerConfig to_pacer_config(const ServiceConfig& config, service::Pace pace, const SourceInfo& source) {
  service::PacerConfig pacer;
  pacer.window = window_of(config, pace);
  pacer.at_once = source.live;
  pacer.period_ns = seconds_to_ns(1.0 / source.fps);
  pacer.max_gap_ns = seconds_to_ns(config.max_gap_s);
  pacer.resend_after_ns = std::int64_t{config.resend_after_ms} * 1'000'000;
  pacer.result_timeout_ns = seconds_to_ns(config.result_timeout_s);
  return pacer;
}

}  // namespace rtd::camera
