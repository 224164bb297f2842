// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "services/launcher/core/run/supervisor.hpp"

namespace rtd::launcher {

/// Section `launcher` of the configuration.
struct LauncherConfig {
  int max_restarts = 5;
  int first_backoff_ms = 200;
  int domain_check_ms = 500;
  int connect_timeout_ms = 15000;
  int interrupt_grace_ms = 1200;
  int finish_grace_ms = 10000;
  int samples = 12;

  void bind(auto& binder) {
    binder.field("max_restarts", max_restarts, {0, 100}, "deaths of a service in a row before it is given up");
    binder.field("first_backoff_ms", first_backoff_ms, {0, 2000},
                 "pause before the first restart, doubled for each further one");
    binder.field("domain_check_ms", domain_check_ms, {0, 10000},
                 "looking for another run in the same domain before anything starts");
    binder.field("connect_timeout_ms", connect_timeout_ms, {0, 60000},
                 "longest time that the camera waits for filter and slam");
    binder.field("interrupt_grace_ms", interrupt_grace_ms, {0, 1500}, "from Ctrl-C to the forced end of a service");
    binder.field("finish_grace_ms", finish_grace_ms, {0, 600000},
                 "from the end of the source to the forced end: slam writes its map");
    binder.field("samples", samples, {1, 100}, "frames kept for the report");
  }
  SupervisorOptions supervisor() const {
    SupervisorOptions options;
    options.max_restarts_in_row = max_restarts;
    options.first_backoff = std::chrono::milliseconds(first_backoff_ms);
    return options;
  }
};

}  // namespace rtd::launcher
