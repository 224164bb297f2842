// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/evaluation/commands/eval_command.hpp"
#include "services/evaluation/core/trajectory/evaluation.hpp"

namespace rtd::launcher {

/// The evaluation for people, about 20 lines.
std::string evaluation_table(const eval::Evaluation& evaluation, const EvalOptions& options);

/// Why nothing associated: the stamps of both sides, and which option may help.
std::string explain_no_pairs(const eval::Trajectory& estimate, const eval::Trajectory& groundtruth,
                             const EvalOptions& options);

}  // namespace rtd::launcher
