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

void ServiceConfig::bind(service::ConfigBinder& binder) {
  binder.field("source", source,
               "where frames come from: tum:FOLDER, bag:FILE, mcap:FILE, ros2:COLOR,DEPTH[,INFO] or "
               "synthetic:SCENE[?key=value&...]");
  binder.field("frames", frames, {0, 1e9}, "play at most this many frames, 0 = all");
  binder.field("jpeg_quality", jpeg_quality, {1, 100}, "of the compressed topic, encoded only while somebody listens");
  binder.field("asap_window", asap_window, {1, 3}, "frames without a result at a time, pace asap");
  binder.field("resend_after_ms", resend_after_ms, {10, 60000}, "silence after which frames in flight are sent again");
  binder.field("result_timeout_s", result_timeout_s, {0.1, 3600}, "silence after which the run has failed");
  binder.field("start_timeout_s", start_timeout_s, {0, 3600},
               "longest wait for a running camera, and for the services of wait_for");
  binder.field("max_gap_s", max_gap_s, {0.01, 3600}, "pace realtime: longer pauses between stamps are cut to this");
  binder.field("wait_for", wait_for, "services that must be ready before the first frame");
  binder.field("groundtruth_out", groundtruth_out, "file that gets the ground truth in TUM format, empty = none");
}

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
