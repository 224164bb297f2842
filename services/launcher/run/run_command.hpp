// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/service/exit_code.hpp"
#include "services/evaluation/core/report/run_summary.hpp"
#include "services/evaluation/record/run_record.hpp"
#include "services/launcher/run/run_options.hpp"

namespace rtd::launcher {

/// What a run left behind.
struct RunResult {
  service::ExitCode code = service::kRunFailed;
  RunRecord record;
  std::optional<RunSummary> summary;  ///< empty: nothing was started
};

/// `rtd run`: checks, starts, supervises, reports. Prints progress to stderr, the summary to stdout. Never throws for
/// what the user can cause: that becomes a message and an exit code.
RunResult run(const RunOptions& options);

}  // namespace rtd::launcher
