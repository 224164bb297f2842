// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/service/config.hpp"
#include "services/filter/core/filter_config.hpp"

namespace rtd::filter {

/// Values of `filter.mode`.
std::vector<std::string> mode_names();

/// Section `filter` of the configuration. The numbers of the core have their defaults in core/filter_config.hpp.
struct ServiceConfig {
  FilterConfig core;
  std::string mode = "rtd";          ///< one of mode_names()
  std::string detector = "auto";     ///< auto: use one that is heard; off: never wait, never use
  int detections_timeout_ms = 5000;  ///< asap, lockstep: longest wait for the boxes of one frame
  int feedback_timeout_ms = 3000;    ///< lockstep: longest wait for slam's result of the previous frame

  void bind(service::ConfigBinder& binder);
  /// `core` with the mode as its enum.
  FilterConfig core_config() const;
};

}  // namespace rtd::filter
