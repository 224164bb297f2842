// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/io/input_file.hpp"
#include "common/service/config.hpp"
#include "services/evaluation/core/experiment/experiment.hpp"
#include "services/evaluation/core/trajectory/evaluation.hpp"
#include "services/evaluation/page/page.hpp"

namespace rtd::eval {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kExperimentFormat = 2;

Json run_json(const ExperimentRun& run) {
  return {{"source", run.source},         {"variant", run.variant}, {"run", run.run},
          {"duration_s", run.duration_s}, {"failure", run.failure}, {"figures", run.figures},
          {"trajectory", run.trajectory}};
}

ExperimentRun run_from(const nlohmann::json& json) {
  return {json.at("source"),  json.at("variant"), json.at("run"),       json.at("duration_s"),
          json.at("failure"), json.at("figures"), json.at("trajectory")};
}

/// Unknown values are null when printed.
Json spread_json(const Spread& spread) {
  return {{"median", spread.median}, {"min", spread.min}, {"max", spread.max}};
}

Json row_json(const ExperimentRow& row) {
  Json json = {{"subject", row.subject}, {"variant", row.variant}, {"runs", row.runs},
               {"failed", row.failed},   {"failure", row.failure}, {"trajectories_differ", row.differ}};
  Json& figures = json["figures"] = Json::object();
  for (const auto& [name, spread] : row.figures) figures[name] = spread_json(spread);
  return json;
}

Json plan_json(const Experiment& experiment) {
  Json json = {{"subjects", Json::array()}, {"variants", Json::array()}, {"left_out", Json::array()}};
  for (const auto& [name, source] : experiment.subjects)
    json["subjects"].push_back({{"name", name}, {"source", source}});
  for (const Variant& one : experiment.variants)
    json["variants"].push_back(
        {{"name", one.name}, {"mode", one.mode}, {"settings", one.settings}, {"meaning", one.meaning}});
  for (const LeftOut& one : experiment.left_out)
    json["left_out"].push_back({{"folder", one.folder}, {"reason", one.reason}});
  return json;
}

Experiment experiment_from(const nlohmann::json& json) {
  Experiment experiment;
  experiment.name = json.at("name");
  experiment.settings = json.at("settings");
  experiment.complete = json.at("complete");
  for (const auto& one : json.at("subjects")) experiment.subjects.push_back({one.at("name"), one.at("source")});
  for (const auto& one : json.at("variants"))
    experiment.variants.push_back({one.at("name"), one.at("mode"), one.at("settings"), one.at("meaning")});
  for (const auto& run : json.at("results")) experiment.results.push_back(run_from(run));
  return experiment;
}

}  // namespace

Json experiment_json(const Experiment& experiment) {
  Json json = {{"format", kExperimentFormat}, {"name", experiment.name},      {"settings", experiment.settings},
               {"runs", experiment.runs},     {"jobs", experiment.jobs},      {"complete", experiment.complete},
               {"baseline", kBaseline},       {"notes", notes_of(experiment)}};
  json.update(plan_json(experiment));
  json["rows"] = json["results"] = Json::array();
  for (const ExperimentRow& row : summarize(experiment)) json["rows"].push_back(row_json(row));
  for (const ExperimentRun& run : experiment.results) json["results"].push_back(run_json(run));
  return json;
}

Experiment read_experiment(const std::string& file) {
  const auto text = io::try_read_file(file, io::kResults);
  if (!text) throw service::ConfigError(file + " cannot be read");
  const nlohmann::json json = nlohmann::json::parse(*text, nullptr, false);
  if (!json.is_object() || json.value("format", nlohmann::json()) != kExperimentFormat)
    throw service::ConfigError(file + " is not a file that 'rtd ablate' or 'rtd benchmark' of this version wrote");
  try {
    return experiment_from(json);
  } catch (const nlohmann::json::exception& error) {
    throw service::ConfigError(file + " is damaged (" + error.what() + "): remove it");
  }
}

namespace {

using Cells = std::vector<std::string>;

/// How a figure of several runs becomes a cell.
enum class Show { kSpread, kMedian, kLeast, kMost, kStates };

struct Column {
  const char* figure;  ///< name in Figures
  const char* head;
  const char* format;
  double factor;
  Show show;
  bool when_known;  ///< the column is there only when a run has the figure
};

constexpr std::array kColumns{
    Column{"ate_m", "ATE [m]", "{:.4f}", 1, Show::kSpread, false},
    Column{"ratio", "to rtd", "{:.2f}", 1, Show::kMedian, false},
    Column{"rpe_m", "RPE [m/s]", "{:.4f}", 1, Show::kMedian, false},
    Column{"rpe_deg", "RPE [deg/s]", "{:.3f}", 1, Show::kMedian, false},
    Column{"coverage", "coverage", "{:.3f}", 1, Show::kLeast, false},
    Column{"precision", "precision", "{:.3f}", 1, Show::kMedian, true},
    Column{"recall", "recall", "{:.3f}", 1, Show::kMedian, true},
    Column{"filter_ms", "filter [ms]", "{:.1f}", 1, Show::kMedian, false},
    Column{"slam_ms", "slam [ms]", "{:.1f}", 1, Show::kMedian, false},
    Column{"share.ok", "states [%]", "{:.3g}", 100, Show::kStates, true},
    Column{"dangerous_share", "dangerous [%]", "{:.2f}", 100, Show::kMost, true},
    Column{"needless_doubt_share", "needless doubt [%]", "{:.2f}", 100, Show::kMedian, true},
    Column{"delay_s_max", "delay [s]", "{:.2f}", 1, Show::kMost, true},
};

/// "0.0024 (0.0021..0.0031)", or one number when all are equal as they are written.
std::string spread_text(const Spread& spread, const char* format) {
  const std::string median = number_text(spread.median, format), min = number_text(spread.min, format),
                    max = number_text(spread.max, format);
  return min == max ? median : fmt::format("{} ({}..{})", median, min, max);
}

/// "97.5/2.5/0/0/0": the medians.
std::string states_cell(const ExperimentRow& row, const Column& column) {
  std::string text;
  for (const char* share : {"share.ok", "share.doubtful", "share.odometry", "share.predicted", "share.lost"})
    text += (text.empty() ? "" : "/") + number_text(column.factor * row.figure(share).median, column.format);
  return text;
}

std::string cell(const ExperimentRow& row, const Column& column) {
  Spread s = row.figure(column.figure);
  for (double* value : {&s.median, &s.min, &s.max}) *value *= column.factor;
  switch (column.show) {
    case Show::kSpread:
      return row.failed == row.runs ? "failed" : spread_text(s, column.format);
    case Show::kMedian:
      return number_text(s.median, column.format);
    case Show::kLeast:
      return number_text(s.min, column.format);
    case Show::kMost:
      return number_text(s.max, column.format);
    case Show::kStates:
      return std::isfinite(s.median) ? states_cell(row, column) : "-";
  }
  return "-";
}

std::vector<Column> known_columns(const std::vector<ExperimentRow>& rows) {
  std::vector<Column> columns;
  std::ranges::copy_if(kColumns, std::back_inserter(columns), [&](const Column& column) {
    return !column.when_known || std::ranges::any_of(rows, [&](const ExperimentRow& row) {
      return std::isfinite(row.figure(column.figure).median);
    });
  });
  return columns;
}

void add_change(const ExperimentRow& row, const std::vector<ExperimentRow>& before, Cells& cells) {
  const auto change = change_of(row, before);
  cells.push_back(change ? number_text(change->before_m, "{:.4f}") : "-");
  cells.push_back(
      change ? fmt::format("{:+.0f} %{}{}", change->percent(), change->verdict.empty() ? "" : " ", change->verdict)
             : "-");
}

Cells row_cells(const ExperimentRow& row, const std::vector<Column>& columns) {
  Cells cells{row.variant,
              row.failed == 0 ? fmt::format("{}", row.runs) : fmt::format("{} of {}", row.runs - row.failed, row.runs)};
  for (const Column& column : columns) cells.push_back(cell(row, column));
  return cells;
}

std::string markdown_line(const Cells& cells) {
  std::string text = "|";
  for (const std::string& one : cells) text += " " + one + " |";
  return text + "\n";
}

std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

/// Lines of cells below each other: the first column left-aligned, the rest right.
std::string aligned_table(const std::vector<Cells>& lines) {
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

/// A subject with the cells of its rows.
struct Part {
  std::string name, source;
  std::vector<Cells> cells;
};

/// The subjects in the order of the rows; the mean comes last.
std::vector<Part> parts_of(const Experiment& experiment, const ExperimentTable& table) {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const std::string& name = table.rows[i].subject;
    if (parts.empty() || parts.back().name != name) {
      const auto subject = std::ranges::find(experiment.subjects, name, &Subject::name);
      parts.push_back({name, subject == experiment.subjects.end() ? "" : subject->source, {}});
    }
    parts.back().cells.push_back(table.cells[i]);
  }
  return parts;
}

std::string source_text(const Part& part) {
  return part.source.empty() ? "of the sequences over which publications give the mean" : part.source;
}

}  // namespace

std::string number_text(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

std::vector<std::string> notes_of(const Experiment& experiment) {
  std::vector<std::string> notes = experiment.notes;
  if (!experiment.complete) notes.emplace_back("incomplete");
  if (const auto frames = experiment.settings.value("frames", 0); frames > 0)
    notes.push_back(fmt::format("only {} frames of each source", frames));
  if (experiment.jobs > 1)
    notes.push_back(fmt::format("{} runs at a time: the ms are larger than those of a run alone", experiment.jobs));
  for (const ExperimentRow& row : summarize(experiment)) {
    if (row.failed > 0)
      notes.push_back(
          fmt::format("{}, {}: {} of {} runs failed: {}", row.subject, row.variant, row.failed, row.runs, row.failure));
    if (row.differ)
      notes.push_back(
          fmt::format("{}, {}: the trajectories of its runs differ, although lockstep gives the same bytes each time",
                      row.subject, row.variant));
  }
  for (const LeftOut& one : experiment.left_out) notes.push_back(one.folder + " is left out: " + one.reason);
  return notes;
}

ExperimentTable table_of(const Experiment& experiment, const Experiment* before) {
  ExperimentTable table{summarize(experiment), {"variant", "runs"}, {}};
  const std::vector<Column> columns = known_columns(table.rows);
  for (const Column& column : columns) table.head.emplace_back(column.head);
  for (const ExperimentRow& row : table.rows) table.cells.push_back(row_cells(row, columns));
  if (before == nullptr) return table;
  table.head.insert(table.head.end(), {"ATE before [m]", "change"});
  const std::vector<ExperimentRow> rows_before = summarize(*before);
  for (std::size_t i = 0; i < table.rows.size(); ++i) add_change(table.rows[i], rows_before, table.cells[i]);
  return table;
}

std::string experiment_text(const Experiment& experiment, const Experiment* before) {
  const ExperimentTable table = table_of(experiment, before);
  std::string text;
  for (Part& part : parts_of(experiment, table)) {
    part.cells.insert(part.cells.begin(), table.head);
    text += "\n" + part.name + ": " + source_text(part) + "\n" + aligned_table(part.cells);
  }
  for (const std::string& note : notes_of(experiment)) text += "  note: " + note + "\n";
  return text;
}

std::string experiment_markdown(const Experiment& experiment, const Experiment* before) {
  const ExperimentTable table = table_of(experiment, before);
  std::string text = "# RTD-SLAM " + experiment.name + "\n\n";
  for (const auto& [key, value] : experiment.settings.items()) text += fmt::format("- {}: `{}`\n", key, value.dump());
  for (const Part& part : parts_of(experiment, table)) {
    text += fmt::format("\n## {}\n`{}`\n\n", part.name, source_text(part)) + markdown_line(table.head);
    text += markdown_line(Cells(table.head.size(), "---"));
    for (const Cells& cells : part.cells) text += markdown_line(cells);
  }
  text += "\n";
  for (const std::string& note : notes_of(experiment)) text += "- " + note + "\n";
  return text;
}

std::string experiment_html(const Experiment& experiment, const Experiment* before) {
  const ExperimentTable table = table_of(experiment, before);
  Json data = experiment_json(experiment);
  data.erase("results");
  data["kind"] = "experiment";
  data["parts"] = Json::array();
  for (const Part& part : parts_of(experiment, table))
    data["parts"].push_back(
        {{"name", part.name}, {"source", source_text(part)}, {"head", table.head}, {"cells", part.cells}});
  return page::filled(data);
}

}  // namespace rtd::eval
