// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/service/exit_code.hpp"
#include "services/launcher/run/run_setup.hpp"

namespace rtd::launcher {

/// Whether a run has report.json and report.html; without rtd-eval, run.json is all there is.
enum class ReportState { kNone, kWritten, kFailed };

/// How a run ended.
struct RunResult {
  service::ExitCode code = service::kRunFailed;
  ReportState report = ReportState::kNone;
  std::string detector;  ///< weights and their licence, or why there is none
};

/// `rtd run`: checks, starts, supervises, reports. Prints progress to stderr, the summary to stdout. Never throws for
/// what the user can cause: that becomes a message and an exit code.
RunResult run(const RunOptions& options);

}  // namespace rtd::launcher
