// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/evaluation/core/report/run_summary.hpp"
#include "services/evaluation/record/run_record.hpp"

namespace rtd::launcher {

/// The table that closes a run on the terminal.
std::string run_summary_text(const RunRecord& record, const RunSummary& summary, const std::string& out_dir);

}  // namespace rtd::launcher
