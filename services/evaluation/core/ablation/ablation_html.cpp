// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/ablation/ablation_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/evaluation/core/plot/chart.hpp"
#include "services/evaluation/core/report/html.hpp"
#include "services/evaluation/core/report/trajectory_plot.hpp"

namespace rtd::eval {
namespace {

namespace palette = plot::palette;
using plot::Anchor;

constexpr double kWidth = 1080, kLabels = 190, kValues = 150, kRow = 27, kTop = 30;

struct Bar {
  std::string label, value, colour;
  double from = 0, to = 0;  ///< on the axis, 0..1
  std::string detail;
};

/// Bars below each other with a line at `zero`, the axis title above.
std::string bar_chart(const std::string& title, const std::vector<Bar>& bars, double zero) {
  const double width = kWidth - kLabels - kValues;
  plot::Svg svg(kWidth, kTop + kRow * static_cast<double>(bars.size()) + 6, title);
  svg.text({kLabels, 14}, title, {palette::kMuted, 12});
  const auto x = [&](double share) { return kLabels + width * std::clamp(share, 0.0, 1.0); };
  svg.line({x(zero), kTop - 6}, {x(zero), svg.height() - 4}, {palette::kFrame, 1});
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const Bar& bar = bars[i];
    const double y = kTop + kRow * static_cast<double>(i);
    const double left = x(std::min(bar.from, bar.to)), right = x(std::max(bar.from, bar.to));
    svg.text({kLabels - 10, y + 15}, bar.label, {palette::kInk, 12.5, Anchor::kEnd});
    svg.rect({left, y + 3, std::max(2.0, right - left), kRow - 9}, bar.colour, 0.9, 3);
    svg.text({right + 8, y + 15}, bar.value, {palette::kInk, 12.5, Anchor::kStart, true});
  }
  return svg.str();
}

/// Errors of the modes differ by a factor of a hundred, so the axis is logarithmic, from the decade below the smallest.
std::string modes_chart(const std::vector<AblationRow>& rows) {
  std::vector<const AblationRow*> known;
  for (const AblationRow& row : rows) {
    if (row.variant.is_mode() && row.ate_m.median > 0) known.push_back(&row);
  }
  if (known.empty()) return "";
  double smallest = known[0]->ate_m.median, largest = smallest;
  for (const AblationRow* row : known) {
    smallest = std::min(smallest, row->ate_m.median);
    largest = std::max(largest, row->ate_m.median);
  }
  const double low = std::floor(std::log10(smallest)), span = std::max(1.0, std::log10(largest) - low) * 1.02;
  std::vector<Bar> bars;
  for (const AblationRow* row : known) {
    const bool ours = row->variant.name == kBaseline;
    bars.push_back({row->variant.name, length_text(row->ate_m.median), ours ? palette::kGreen : palette::kBlue, 0,
                    (std::log10(row->ate_m.median) - low) / span, ""});
  }
  return html::section("Error of each mode", "ATE RMSE, logarithmic axis; shorter is better.",
                       bar_chart(fmt::format("from {} to the right, a factor of ten each {:.0f} % of the width",
                                             length_text(std::pow(10, low)), 100 / span),
                                 bars, 0));
}

/// The error without a technique, as a factor: to the right the technique helps, to the left it harms.
std::string techniques_chart(const std::vector<AblationRow>& rows) {
  constexpr double kSmall = 0.02;  // a smaller difference is grey
  std::vector<Bar> bars;
  double reach = std::log2(1.25);
  for (const AblationRow& row : rows) {
    if (!row.variant.is_mode() && row.ratio > 0) reach = std::max(reach, std::abs(std::log2(row.ratio)));
  }
  for (const AblationRow& row : rows) {
    if (row.variant.is_mode() || !(row.ratio > 0)) continue;
    const char* colour = row.ratio > 1 + kSmall   ? palette::kGreen
                         : row.ratio < 1 - kSmall ? palette::kRed
                                                  : palette::kTruth;
    bars.push_back({row.variant.name, fmt::format("x {:.2f}", row.ratio), colour, 0.5,
                    0.5 + 0.48 * std::log2(row.ratio) / reach, row.variant.meaning});
  }
  if (bars.empty()) return "";
  return html::section("What each technique is worth",
                       "ATE of rtd without the technique, as a multiple of rtd's. Green, to the right: the technique "
                       "pays here; red, to the left: it costs; grey: no difference (2 %).",
                       bar_chart("ATE without it / ATE with it, logarithmic", bars, 0.5));
}

std::string numbers_section(const std::vector<AblationRow>& rows) {
  html::Table table{ablation_head(), {}};
  for (const AblationRow& row : rows) table.rows.push_back(ablation_cells(row));
  std::vector<std::string> meanings;
  for (const AblationRow& row : rows) {
    if (!row.variant.meaning.empty()) meanings.push_back(row.variant.name + ": " + row.variant.meaning);
  }
  return html::section("Numbers",
                       "Precision and recall of removed points against the true moving pixels grown by 3 px, "
                       "after the first second. filter: median a frame, ORB extraction included.",
                       html::table(table) + (meanings.empty() ? "" : html::list(meanings)));
}

}  // namespace

std::string ablation_html(const Ablation& ablation) {
  const std::vector<AblationRow> rows = summarize(ablation);
  std::string body =
      "<div style=\"margin:-8px 0 18px\">" +
      html::badges(
          {{"pace", ablation.pace}, {"runs each", fmt::format("{}", ablation.runs)}, {"version", ablation.version}}) +
      "</div>\n";
  const std::vector<std::string> notes = ablation_notes(ablation, rows);
  if (!notes.empty()) body += html::section("Notes", "", html::list(notes));
  for (std::size_t i = 0; i < ablation.sources.size(); ++i) {
    std::vector<AblationRow> of_source;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(of_source),
                 [&](const AblationRow& row) { return row.source == ablation.source_names[i]; });
    if (of_source.empty()) continue;
    body +=
        "<h1 style=\"font-size:22px;margin:26px 0 10px\">" + plot::escape_markup(ablation.source_names[i]) + "</h1>\n";
    body += modes_chart(of_source) + techniques_chart(of_source) + numbers_section(of_source);
  }
  return html::page("RTD-SLAM ablation",
                    fmt::format("{} source{}, baseline {}", ablation.sources.size(),
                                ablation.sources.size() == 1 ? "" : "s", kBaseline),
                    body);
}

}  // namespace rtd::eval
