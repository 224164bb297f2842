// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/run_record/run_record.hpp"
#include "common/service/exit_code.hpp"
#include "services/launcher/run/run_setup.hpp"

namespace rtd::launcher {

/// Joins what the services wrote into `folder` (common/service/trace.hpp) to one file in the Trace Event Format, which
/// Perfetto and chrome://tracing open, and removes the folder. The last line of a killed process may be cut off; it is
/// left out. Returns why that failed; empty when it did not.
std::string join_trace(const std::string& folder, const std::string& path);

/// Whether frames are missing because camera, filter or slam died: what a running camera would have given meanwhile is
/// among them.
bool died_with_frames(const run_record::RunRecord& record);

/// Whether what the run gives is not that of its source: no more than half of the frames were used, a service died with
/// some, or those of a second camera were among them.
bool is_partial(const run_record::RunRecord& record);

/// Why frames of a run were not used: how many were, the service that died with them or the commonest cause, and what
/// helps. `first_left_out`: the first piece that the source left out, as the camera describes it; may be empty. Empty
/// when nine of ten frames were used, none died with a service and none are of a second camera.
std::string why_not_used(const run_record::RunRecord& record, const std::string& first_left_out);

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
