// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/evaluation/core/report/report.hpp"

namespace rtd::launcher {

/// The page of write_comparison_html as text.
std::string comparison_html(const std::vector<ComparedRun>& runs);

}  // namespace rtd::launcher
