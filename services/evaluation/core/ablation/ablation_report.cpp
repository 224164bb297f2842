// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/ablation/ablation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "services/evaluation/core/plot/chart.hpp"
#include "services/evaluation/core/report/html.hpp"
#include "services/evaluation/core/report/trajectory_plot.hpp"
#include "services/evaluation/core/trajectory/evaluation.hpp"

namespace rtd::eval {
namespace {

using Json = nlohmann::ordered_json;

std::string markdown_line(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text += " " + cell + " |";
  return text + "\n";
}

Json row_json(const AblationRow& row) {
  return {{"variant", row.variant.name},
          {"mode", row.variant.mode},
          {"settings", row.variant.settings},
          {"meaning", row.variant.meaning.empty() ? Json(nullptr) : Json(row.variant.meaning)},
          {"runs", row.runs},
          {"failed", row.failed},
          {"failure", row.failure.empty() ? Json(nullptr) : Json(row.failure)},
          {"ate_rmse_m", spread_json(row.ate_m)},
          {"ate_ratio", number_or_null(row.ratio)},
          {"rpe_trans_rmse_m", spread_json(row.rpe_m)},
          {"rpe_rot_rmse_deg", spread_json(row.rpe_deg)},
          {"coverage", spread_json(row.coverage)},
          {"precision", spread_json(row.precision)},
          {"recall", spread_json(row.recall)},
          {"filter_ms", spread_json(row.filter_ms)},
          {"trajectories_differ", row.unlike}};
}

namespace palette = plot::palette;
using plot::Anchor;

constexpr double kWidth = 1080, kLabels = 190, kValues = 150, kRow = 27, kTop = 30;

struct Bar {
  std::string label, value, colour;
  double from = 0, to = 0;  ///< on the axis, 0..1
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
                    (std::log10(row->ate_m.median) - low) / span});
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
    bars.push_back(
        {row.variant.name, fmt::format("x {:.2f}", row.ratio), colour, 0.5, 0.5 + 0.48 * std::log2(row.ratio) / reach});
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

std::vector<AblationRow> rows_of(const std::vector<AblationRow>& rows, const std::string& source) {
  std::vector<AblationRow> chosen;
  std::ranges::copy_if(rows, std::back_inserter(chosen), [&](const AblationRow& row) { return row.source == source; });
  return chosen;
}

std::vector<std::string> ablation_head() {
  return {"variant", "ATE [m]", "to rtd", "RPE [m/s]", "RPE [deg/s]", "coverage", "precision", "recall", "filter [ms]"};
}

std::vector<std::string> ablation_cells(const AblationRow& row) {
  if (row.failed == row.runs) return {row.variant.name, "failed", "-", "-", "-", "-", "-", "-", "-"};
  return {row.variant.name,
          spread_text(row.ate_m, "{:.4f}"),
          number_text(row.ratio, "{:.2f}"),
          spread_text(row.rpe_m, "{:.4f}"),
          spread_text(row.rpe_deg, "{:.3f}"),
          spread_text(row.coverage, "{:.3f}"),
          spread_text(row.precision, "{:.3f}"),
          spread_text(row.recall, "{:.3f}"),
          spread_text(row.filter_ms, "{:.1f}")};
}

std::vector<std::string> ablation_notes(const Ablation& ablation, const std::vector<AblationRow>& rows) {
  std::vector<std::string> notes = ablation.plan.notes;
  notes.insert(notes.end(), ablation.notes.begin(), ablation.notes.end());
  if (!ablation.complete) notes.emplace_back("incomplete: continue with --resume");
  for (const AblationRow& row : rows) {
    if (row.failed > 0)
      notes.push_back(fmt::format("{}, {}: {} of {} runs failed: {}", row.source, row.variant.name, row.failed,
                                  row.runs, row.failure));
    if (row.unlike)
      notes.push_back(
          fmt::format("{}, {}: the trajectories of its runs differ, although lockstep gives the same bytes "
                      "each time",
                      row.source, row.variant.name));
  }
  return notes;
}

std::string ablation_text(const Ablation& ablation) {
  const std::vector<AblationRow> rows = summarize(ablation);
  std::string text;
  for (std::size_t i = 0; i < ablation.sources.size(); ++i) {
    std::vector<std::vector<std::string>> lines = {ablation_head()};
    for (const AblationRow& row : rows_of(rows, ablation.source_names[i])) lines.push_back(ablation_cells(row));
    if (lines.size() > 1) text += "\n" + ablation.sources[i] + "\n" + aligned_table(lines);
  }
  for (const std::string& note : ablation_notes(ablation, rows)) text += "  note: " + note + "\n";
  return text;
}

std::string ablation_markdown(const Ablation& ablation) {
  const std::vector<AblationRow> rows = summarize(ablation);
  std::string text = fmt::format(
      "# Ablation\n\nPace {}, {} run{} each, rtd {}. Precision and recall of removed points: after the first "
      "second.\n",
      ablation.pace, ablation.runs, ablation.runs == 1 ? "" : "s", ablation.version);
  for (std::size_t i = 0; i < ablation.sources.size(); ++i) {
    const std::vector<AblationRow> of_source = rows_of(rows, ablation.source_names[i]);
    if (of_source.empty()) continue;
    text += fmt::format("\n## {}\n`{}`\n\n", ablation.source_names[i], ablation.sources[i]);
    text += markdown_line(ablation_head());
    text += markdown_line(std::vector<std::string>(ablation_head().size(), "---"));
    for (const AblationRow& row : of_source) text += markdown_line(ablation_cells(row));
  }
  const std::vector<std::string> notes = ablation_notes(ablation, rows);
  if (!notes.empty()) text += "\n";
  for (const std::string& note : notes) text += "- " + note + "\n";
  return text;
}

Json ablation_json(const Ablation& ablation) {
  const std::vector<AblationRow> rows = summarize(ablation);
  Json json = {{"version", ablation.version},
               {"pace", ablation.pace},
               {"runs", ablation.runs},
               {"complete", ablation.complete},
               {"baseline", kBaseline},
               {"sources", Json::array()},
               {"notes", ablation_notes(ablation, rows)}};
  for (std::size_t i = 0; i < ablation.sources.size(); ++i) {
    Json of_source = {{"name", ablation.source_names[i]}, {"source", ablation.sources[i]}, {"rows", Json::array()}};
    for (const AblationRow& row : rows_of(rows, ablation.source_names[i])) of_source["rows"].push_back(row_json(row));
    json["sources"].push_back(of_source);
  }
  return json;
}

std::string ablation_html(const Ablation& ablation) {
  const std::vector<AblationRow> rows = summarize(ablation);
  std::string body = html::badges(
      {{"pace", ablation.pace}, {"runs each", fmt::format("{}", ablation.runs)}, {"version", ablation.version}});
  const std::vector<std::string> notes = ablation_notes(ablation, rows);
  if (!notes.empty()) body += html::section("Notes", "", html::list(notes));
  for (std::size_t i = 0; i < ablation.sources.size(); ++i) {
    const std::vector<AblationRow> of_source = rows_of(rows, ablation.source_names[i]);
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
