// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/report/spread.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "services/evaluation/core/trajectory/evaluation.hpp"

namespace rtd::eval {

Spread spread_of(const std::vector<double>& values) {
  std::vector<double> known;
  std::ranges::copy_if(values, std::back_inserter(known), [](double v) { return std::isfinite(v); });
  if (known.empty()) return {};
  std::ranges::sort(known);
  const std::size_t n = known.size();
  return {n % 2 == 1 ? known[n / 2] : (known[n / 2 - 1] + known[n / 2]) / 2, known.front(), known.back()};
}

nlohmann::ordered_json spread_json(const Spread& spread) {
  return {{"median", number_or_null(spread.median)},
          {"min", number_or_null(spread.min)},
          {"max", number_or_null(spread.max)}};
}

std::string number_text(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

std::string spread_text(const Spread& spread, const char* format) {
  const std::string median = number_text(spread.median, format), min = number_text(spread.min, format),
                    max = number_text(spread.max, format);
  return min == max ? median : fmt::format("{} ({}..{})", median, min, max);
}

namespace {

/// Characters of a UTF-8 text.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

}  // namespace

std::string aligned_table(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths(lines.front().size(), 0);
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], width_of(line[i]));
  }
  std::string text;
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      text += i == 0 ? fmt::format("  {:<{}}", line[i], widths[i]) : fmt::format("  {:>{}}", line[i], widths[i]);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  return text;
}

}  // namespace rtd::eval
