// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/service/pacer.hpp"
#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {

/// Section `camera` of the configuration.
struct ServiceConfig {
  std::string source = "synthetic:office";
  int frames = 0;
  int jpeg_quality = 90;
  int asap_window = 3;
  int resend_after_ms = 2000;
  double result_timeout_s = 30;
  double start_timeout_s = 30;
  double max_gap_s = 1.0;
  std::vector<std::string> wait_for = {"filter", "slam"};
  std::string groundtruth_out;
  std::string export_folder;  ///< only for the help of --export, which runs no service

  void bind(auto& binder) {
    binder.field("source", source,
                 "where frames come from: tum:FOLDER, bag:FILE, mcap:FILE, ros2:COLOR,DEPTH[,INFO] or "
                 "synthetic:SCENE[?key=value&...]");
    binder.field("frames", frames, {0, 1e9}, "play at most this many frames, 0 = all");
    binder.field("jpeg_quality", jpeg_quality, {1, 100}, "of the compressed topic, encoded only while it has readers");
    binder.field("asap_window", asap_window, {1, 3}, "pace asap: frames without a result at a time");
    binder.field("resend_after_ms", resend_after_ms, {10, 60000},
                 "silence after which frames in flight are sent again");
    binder.field("result_timeout_s", result_timeout_s, {0.1, 3600}, "silence after which the run has failed");
    binder.field("start_timeout_s", start_timeout_s, {0, 3600},
                 "longest wait for a running camera, and for the services of wait_for");
    binder.field("max_gap_s", max_gap_s, {0.01, 3600}, "pace realtime: longer pauses between stamps are cut to this");
    binder.field("wait_for", wait_for, "services that must be ready before the first frame");
    binder.field("groundtruth_out", groundtruth_out, "file that gets the ground truth in TUM format, empty = none");
  }
};

/// What the pacer needs for such a source.
service::PacerConfig to_pacer_config(const ServiceConfig& config, service::Pace pace, const SourceInfo& source);

}  // namespace rtd::camera
