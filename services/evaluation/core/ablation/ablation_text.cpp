// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/ablation/ablation_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "services/evaluation/core/trajectory/evaluation.hpp"

namespace rtd::eval {
namespace {

using Json = nlohmann::ordered_json;

std::string number(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

std::string spread(const Spread& s, const char* format) {
  const std::string median = number(s.median, format), min = number(s.min, format), max = number(s.max, format);
  return min == max ? median : fmt::format("{} ({}..{})", median, min, max);
}

std::vector<AblationRow> rows_of(const std::vector<AblationRow>& rows, const std::string& source) {
  std::vector<AblationRow> chosen;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(chosen),
               [&](const AblationRow& row) { return row.source == source; });
  return chosen;
}

std::string aligned_table(const std::vector<std::vector<std::string>>& lines) {
  std::vector<std::size_t> widths(lines.front().size(), 0);
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
  }
  std::string text;
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      text += i == 0 ? fmt::format("  {:<{}}", line[i], widths[i]) : fmt::format("  {:>{}}", line[i], widths[i]);
    }
    text += '\n';
  }
  return text;
}

std::string markdown_line(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text += " " + cell + " |";
  return text + "\n";
}

Json spread_json(const Spread& s) {
  return {{"median", number_or_null(s.median)}, {"min", number_or_null(s.min)}, {"max", number_or_null(s.max)}};
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

}  // namespace

std::vector<std::string> ablation_head() {
  return {"variant", "ATE [m]", "to rtd", "RPE [m/s]", "RPE [deg/s]", "coverage", "precision", "recall", "filter [ms]"};
}

std::vector<std::string> ablation_cells(const AblationRow& row) {
  if (row.failed == row.runs) return {row.variant.name, "failed", "-", "-", "-", "-", "-", "-", "-"};
  return {row.variant.name,
          spread(row.ate_m, "{:.4f}"),
          number(row.ratio, "{:.2f}"),
          spread(row.rpe_m, "{:.4f}"),
          spread(row.rpe_deg, "{:.3f}"),
          spread(row.coverage, "{:.3f}"),
          spread(row.precision, "{:.3f}"),
          spread(row.recall, "{:.3f}"),
          spread(row.filter_ms, "{:.1f}")};
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

}  // namespace rtd::eval
