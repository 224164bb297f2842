// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/evaluation/core/report/run_summary.hpp"

namespace rtd::launcher {

/// The report page of one run: one HTML file with everything inside (styles, SVG charts, JPEG as data URIs), no
/// references to the outside, no script.
std::string report_html(const RunRecord& record, const RunSummary& summary);

}  // namespace rtd::launcher
