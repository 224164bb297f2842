// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/service/config.hpp"
#include "common/service/pace.hpp"
#include "services/replay/core/player.hpp"

namespace rtd::replay {

/// Section `replay` of the configuration.
struct ServiceConfig {
  std::string file;
  double rate = 1;  ///< 0: as fast as possible
  bool loop = false;
  double start_offset_s = 0, duration_s = 0;  ///< duration 0: to the end
  std::vector<std::string> topics, exclude;
  std::vector<std::string> remap;
  double clock_hz = 0;  ///< 0: no clock
  bool pause = false;
  int read_ahead_mb = 64;
  std::string lockstep;     ///< topic that answers; with --pace lockstep or asap: rtd/tracking
  std::string paced_topic;  ///< topic that waits for answers; empty: rtd/frame, else rtd/features
  int asap_window = 3;
  int resend_after_ms = 2000;
  double result_timeout_s = 30;
  std::vector<std::string> wait_for;  ///< services that must be ready first
  double start_timeout_s = 30;
  double wait_readers_s = 1;
  bool restamp = false;
  std::vector<std::string> stand_in;  ///< services for which heartbeats are sent: others take them for running
  bool json = false;

  void bind(service::ConfigBinder& binder);
};

/// Throws ConfigError naming the option, the value and what is allowed.
void validate(const ServiceConfig& config);

/// How many paced messages may be without an answer; 0: by time.
int window_of(const ServiceConfig& config, service::Pace pace);

}  // namespace rtd::replay
