// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "services/evaluation/core/trajectory/evaluation.hpp"

namespace rtd::eval {

/// {count, rmse, mean, median, std, min, max}, every error times `factor`; unknown values become null when printed.
nlohmann::ordered_json to_json(const Statistics& statistics, double factor = 1);

/// Machine-readable form of an evaluation; keys in docs/evaluation.md. Metres, degrees, seconds.
nlohmann::ordered_json to_json(const Evaluation& evaluation);

}  // namespace rtd::eval
