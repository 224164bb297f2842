// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace rtd::eval {

/// Median and extremes of a figure over several runs; NaN when it is unknown.
struct Spread {
  double median = std::numeric_limits<double>::quiet_NaN();
  double min = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
};

/// Of the finite values.
Spread spread_of(const std::vector<double>& values);

/// {median, min, max}; unknown values are null.
nlohmann::ordered_json spread_json(const Spread& spread);

/// The value in a format such as "{:.3f}"; "-" when it is unknown.
std::string number_text(double value, const char* format);

/// "0.0024 (0.0021..0.0031)", or one number when all are equal as they are written.
std::string spread_text(const Spread& spread, const char* format);

/// Lines of cells below each other for the terminal: the first column left-aligned, the rest right. The first line is
/// the head.
std::string aligned_table(const std::vector<std::vector<std::string>>& lines);

}  // namespace rtd::eval
