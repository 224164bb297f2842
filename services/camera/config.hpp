// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/service/config.hpp"
#include "common/service/pace.hpp"
#include "common/service/pacer.hpp"
#include "services/camera/core/frame_source.hpp"

namespace rtd::camera {

/// Section `camera` of the configuration.
struct ServiceConfig {
  std::string source = "synthetic:office";  ///< URI, see source_factory.hpp
  int frames = 0;                           ///< play at most this many, 0 = all
  int jpeg_quality = 90;
  int asap_window = 3;  ///< frames in flight at pace asap
  int resend_after_ms = 2000;
  double result_timeout_s = 30;
  double start_timeout_s = 30;
  double max_gap_s = 1.0;                                  ///< realtime: longer pauses between stamps are cut to this
  std::vector<std::string> wait_for = {"filter", "slam"};  ///< services that must be ready before the first frame
  std::string groundtruth_out;                             ///< file for the ground truth in TUM format; empty = none
  std::string export_folder;                               ///< --export only: not a service run

  void bind(service::ConfigBinder& binder);
};

/// What the pacer needs for such a source.
service::PacerConfig to_pacer_config(const ServiceConfig& config, service::Pace pace, const SourceInfo& source);

}  // namespace rtd::camera
