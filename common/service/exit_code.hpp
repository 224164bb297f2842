// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::service {

/// Exit codes of every executable (docs/architecture.md).
enum ExitCode : int {
  kOk = 0,
  kRunFailed = 1,      ///< the run started and failed
  kUsageOrConfig = 2,  ///< wrong arguments, configuration or environment: nothing was started
  kPartialLoss = 3,    ///< done, but part of the input was damaged and is lost or left out
  kAlreadyRuns = 4,    ///< this user's service of that name runs already in the domain; may be tried again later
  kInterrupted = 130,  ///< Ctrl-C (launcher only; a service that is asked to stop ends with 0)
};

}  // namespace rtd::service
