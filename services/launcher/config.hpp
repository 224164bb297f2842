// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/service/config.hpp"
#include "services/launcher/core/run/supervisor.hpp"

namespace rtd::launcher {

/// Keys of the section `launcher`.
struct LauncherConfig {
  int max_restarts = 5;            ///< deaths of a service in a row before it is given up
  int first_backoff_ms = 200;      ///< pause before the first restart, doubled for each further one
  int domain_check_ms = 500;       ///< listening for another run in the same domain before anything starts
  int connect_timeout_ms = 15000;  ///< the camera starts when filter and slam are heard, at the latest after this
  int interrupt_grace_ms = 1200;   ///< from Ctrl-C to the forced end
  int finish_grace_ms = 10000;     ///< from the end of the source to the forced end: slam writes its map
  int samples = 12;                ///< frames kept for the report

  void bind(service::ConfigBinder& binder);
  SupervisorOptions supervisor() const;
};

}  // namespace rtd::launcher
