// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/report/report_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/evaluation/core/report/trajectory_plot.hpp"

namespace rtd::eval {
namespace {

std::vector<std::string> length_row(const std::string& name, const Statistics& s) {
  if (s.count == 0) return {name, "-", "-", "-", "-"};
  const LengthUnit unit = length_unit(s.rmse);
  const auto text = [&](double value_m) { return fmt::format("{:.2f}", value_m * unit.per_metre); };
  return {name + " [" + unit.name + "]", text(s.rmse), text(s.median), text(s.max), fmt::format("{}", s.count)};
}

std::vector<std::string> angle_row(const std::string& name, const Statistics& s) {
  if (s.count == 0) return {name, "-", "-", "-", "-"};
  const auto text = [&](double value_rad) { return fmt::format("{:.2f}", value_rad * kRadToDeg); };
  return {name + " [deg]", text(s.rmse), text(s.median), text(s.max), fmt::format("{}", s.count)};
}

std::string caption(const SampleFrame& sample) {
  const auto removed = std::count_if(sample.features.begin(), sample.features.end(),
                                     [](const JudgedFeature& feature) { return feature.removed; });
  return fmt::format("frame {}: {} kept, {} removed", sample.seq,
                     sample.features.size() - static_cast<std::size_t>(removed), removed);
}

}  // namespace

std::string number_text(double value, int decimals, const std::string& unit) {
  if (!std::isfinite(value)) return "unknown";
  return fmt::format("{:.{}f}{}{}", value, decimals, unit.empty() ? "" : " ", unit);
}

std::string percent_text(double fraction) {
  if (!std::isfinite(fraction)) return "unknown";
  // Never round up to 100 %: one lost frame must show.
  const double percent = fraction < 1 ? std::floor(fraction * 1e4 + 1e-6) / 100 : fraction * 100;
  return fmt::format("{:.{}f} %", percent, fraction == 1 ? 0 : 2);
}

html::Table accuracy_table(const Evaluation& e) {
  return {{"error", "RMSE", "median", "max", "pairs"},
          {length_row("ATE", e.ate.error_m), length_row("RPE per second", e.rpe_per_second.translation_m),
           angle_row("RPE per second", e.rpe_per_second.rotation_rad),
           length_row("RPE per frame", e.rpe_per_frame.translation_m),
           angle_row("RPE per frame", e.rpe_per_frame.rotation_rad),
           length_row("RPE per metre", e.rpe_per_metre.translation_m),
           angle_row("RPE per metre", e.rpe_per_metre.rotation_rad)}};
}

std::vector<html::Figure> sample_figures(const Run& run, std::size_t wanted) {
  std::vector<html::Figure> figures;
  const std::size_t count = std::min(wanted, run.samples.size());
  for (std::size_t i = 0; i < count; ++i) {
    const SampleFrame& sample = run.samples[(2 * i + 1) * run.samples.size() / (2 * count)];
    std::string picture = sample_picture(sample);
    if (!picture.empty()) figures.push_back({std::move(picture), caption(sample)});
  }
  return figures;
}

}  // namespace rtd::eval
