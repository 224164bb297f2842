// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "services/evaluation/core/ablation/ablation_result.hpp"

namespace rtd::eval {

/// Headings and cells of one row of the table; "-" = unknown. With several unequal runs: median (min..max).
std::vector<std::string> ablation_head();
std::vector<std::string> ablation_cells(const AblationRow& row);

/// Notes beside the table: what was left out, what failed, what is unexpected.
std::vector<std::string> ablation_notes(const Ablation& ablation, const std::vector<AblationRow>& rows);

/// Tables for the terminal, aligned.
std::string ablation_text(const Ablation& ablation);
/// ablation.md
std::string ablation_markdown(const Ablation& ablation);
/// ablation.json (keys: docs/evaluation.md)
nlohmann::ordered_json ablation_json(const Ablation& ablation);

/// ablation.html: for each source the errors of the modes, the effect of each technique, the numbers. Self-contained.
std::string ablation_html(const Ablation& ablation);

}  // namespace rtd::eval
