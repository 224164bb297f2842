// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "services/evaluation/core/report/run_summary.hpp"

namespace rtd::launcher {

/// The content of report.json (keys: docs/evaluation.md). Every key is always there; what is unknown is null.
nlohmann::ordered_json report_json(const RunRecord& record, const RunSummary& summary);

}  // namespace rtd::launcher
