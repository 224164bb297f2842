// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "services/evaluation/core/trajectory/integrity.hpp"

namespace rtd::eval {

/// Keys: docs/evaluation.md. Metres, degrees, seconds; unknown values are null when printed.
nlohmann::ordered_json to_json(const Drift& drift);
nlohmann::ordered_json to_json(const Integrity& integrity);

/// A figure for people: what it is of, and its value with unit.
using NamedFigure = std::pair<std::string, std::string>;
/// Drift in metres, degrees and their quotient, with what a nearly constant one means.
std::vector<NamedFigure> drift_figures(const Drift& drift, const std::optional<double>& scene_depth_m);
std::vector<NamedFigure> integrity_figures(const Integrity& integrity);

}  // namespace rtd::eval
