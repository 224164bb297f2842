// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/evaluation/core/ablation/ablation_result.hpp"

namespace rtd::launcher {

/// ablation.html: for each source the errors of the modes, what each technique is worth, the numbers. Self-contained.
std::string ablation_html(const Ablation& ablation);

}  // namespace rtd::launcher
