// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/config.hpp"

namespace rtd::launcher {

void LauncherConfig::bind(service::ConfigBinder& binder) {
  binder.field("max_restarts", max_restarts, {0, 100}, "deaths of a service in a row before it is given up");
  binder.field("first_backoff_ms", first_backoff_ms, {0, 2000}, "pause before the first restart, then doubled");
  binder.field("domain_check_ms", domain_check_ms, {0, 10000}, "listening for another run before anything starts");
  binder.field("connect_timeout_ms", connect_timeout_ms, {0, 60000}, "the camera waits so long for filter and slam");
  binder.field("interrupt_grace_ms", interrupt_grace_ms, {0, 1500}, "from Ctrl-C to the forced end of a service");
  binder.field("finish_grace_ms", finish_grace_ms, {0, 600000}, "from the end of the source to the forced end");
  binder.field("samples", samples, {1, 100}, "frames kept for the report");
}

SupervisorOptions LauncherConfig::supervisor() const {
  SupervisorOptions options;
  options.max_restarts_in_row = max_restarts;
  options.first_backoff = std::chrono::milliseconds(first_backoff_ms);
  return options;
}

}  // namespace rtd::launcher
