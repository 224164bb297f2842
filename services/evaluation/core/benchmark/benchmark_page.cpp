// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "services/evaluation/core/benchmark/benchmark.hpp"
#include "services/evaluation/core/benchmark/published.hpp"
#include "services/evaluation/core/plot/svg.hpp"
#include "services/evaluation/core/report/html.hpp"

namespace rtd::eval {
namespace {

/// How a figure of several runs becomes a cell.
enum class Show { kSpread, kMedian, kLeast, kMost, kStates };

struct Column {
  const char* figure;  ///< name in Figures
  const char* head;
  const char* format;
  double factor;
  Show show;
  bool in_terminal;
  bool when_known;  ///< the column is there only when a run has the figure
};

constexpr std::array kColumns{
    Column{"ate_m", "ATE [m]", "{:.4f}", 1, Show::kSpread, true, false},
    Column{"online_ate_m", "ATE online [m]", "{:.4f}", 1, Show::kMedian, false, false},
    Column{"rpe_m", "RPE [m/s]", "{:.4f}", 1, Show::kMedian, true, false},
    Column{"rpe_deg", "RPE [deg/s]", "{:.3f}", 1, Show::kMedian, true, false},
    Column{"coverage", "coverage", "{:.3f}", 1, Show::kLeast, true, false},
    Column{"ms", "ms", "{:.1f}", 1, Show::kMedian, true, false},
    Column{"share.ok", "ok/doubtful/odometry/predicted/lost %", "{:.3g}", 100, Show::kStates, true, false},
    Column{"integrity.dangerous_share", "dangerous, most %", "{:.2f}", 100, Show::kMost, true, true},
    Column{"integrity.needless_doubt_share", "needless doubt %", "{:.2f}", 100, Show::kMedian, true, true},
    Column{"integrity.delay_s_max", "delay, most [s]", "{:.2f}", 1, Show::kMost, true, true},
};

/// "0.0153 (0.0141–0.0170)": median, best and worst run.
std::string spread_cell(const Spread& s, const char* format) {
  const std::string median = number_text(s.median, format), best = number_text(s.min, format),
                    worst = number_text(s.max, format);
  return best == worst ? median : fmt::format("{} ({}–{})", median, best, worst);
}

/// "97.5 / 2.5 / 0 / 0 / 0": the medians.
std::string states_cell(const BenchmarkRow& row, const Column& column) {
  std::string text;
  for (const char* share : {"share.ok", "share.doubtful", "share.odometry", "share.predicted", "share.lost"})
    text += (text.empty() ? "" : " / ") + number_text(column.factor * row.figure(share).median, column.format);
  return text;
}

std::string cell(const BenchmarkRow& row, const Column& column) {
  Spread s = row.figure(column.figure);
  for (double* value : {&s.median, &s.min, &s.max}) *value *= column.factor;
  switch (column.show) {
    case Show::kSpread:
      return spread_cell(s, column.format);
    case Show::kMedian:
      return number_text(s.median, column.format);
    case Show::kLeast:
      return number_text(s.min, column.format);
    case Show::kMost:
      return number_text(s.max, column.format);
    case Show::kStates:
      return states_cell(row, column);
  }
  return "-";
}

/// What is shown, and where.
struct View {
  const Benchmark& benchmark;
  const std::vector<BenchmarkRow> rows;
  const std::vector<BenchmarkRow> before;  ///< of --compare
  const bool compares, terminal;
  std::vector<Column> columns;
};

View view_of(const Benchmark& benchmark, const Benchmark* before, bool terminal) {
  View view{benchmark,
            summarize(benchmark),
            before ? summarize(*before) : std::vector<BenchmarkRow>{},
            before != nullptr,
            terminal,
            {}};
  for (const Column& column : kColumns) {
    const bool known = std::ranges::any_of(
        view.rows, [&](const BenchmarkRow& row) { return std::isfinite(row.figure(column.figure).median); });
    if ((!terminal || column.in_terminal) && (known || !column.when_known)) view.columns.push_back(column);
  }
  return view;
}

std::vector<std::string> head(const View& view) {
  std::vector<std::string> cells{"method"};
  if (!view.terminal) cells.emplace_back("how");
  cells.emplace_back("runs");
  for (const Column& column : view.columns)
    cells.emplace_back(column.show == Show::kStates && !view.terminal ? "states %" : column.head);
  if (view.compares) cells.insert(cells.end(), {"ATE before [m]", "change"});
  return cells;
}

void add_change(const View& view, const BenchmarkRow& row, std::vector<std::string>& cells) {
  const auto change = change_of(row, view.before);
  cells.push_back(change ? number_text(change->before_m, "{:.4f}") : "-");
  cells.push_back(
      change ? fmt::format("{:+.0f} %{}{}", change->percent(), change->verdict.empty() ? "" : " ", change->verdict)
             : "-");
}

std::vector<std::string> row_cells(const View& view, const BenchmarkRow& row) {
  std::vector<std::string> cells{row.mode};
  if (!view.terminal) cells.emplace_back("SE(3), CPU");
  cells.push_back(row.failed == 0 ? fmt::format("{}", row.runs)
                                  : fmt::format("{} of {}", row.runs - row.failed, row.runs));
  for (const Column& column : view.columns) cells.push_back(cell(row, column));
  if (view.compares) add_change(view, row, cells);
  return cells;
}

/// NaN for what publications do not have.
double published_value(const PublishedFigure& figure, const std::string& name) {
  if (name == "ate_m") return figure.ate_m;
  if (name == "rpe_m") return figure.rpe_m;
  return name == "rpe_deg" ? figure.rpe_deg : std::nan("");
}

/// "Sim(3), GPU [5]"; what is not stated is left out.
std::string how(const PublishedMethod& method) {
  std::string text;
  if (method.alignment != PublishedAlignment::kNotStated) text += to_string(method.alignment);
  if (method.hardware != PublishedHardware::kNotStated)
    text += (text.empty() ? "" : ", ") + std::string(to_string(method.hardware));
  return text + fmt::format("{}[{}]", text.empty() ? "" : " ", method.number);
}

/// What is unknown of a publication is left empty; the digits are those that were published.
std::vector<std::string> published_cells(const View& view, const PublishedMethod& method,
                                         const PublishedFigure& figure) {
  std::vector<std::string> cells{method.method};
  if (!view.terminal) cells.push_back(how(method));
  cells.emplace_back();
  for (const Column& column : view.columns) {
    const double value = published_value(figure, column.figure);
    cells.push_back(std::isfinite(value) ? number_text(value, "{:g}") : "");
  }
  if (view.compares) cells.insert(cells.end(), {"", ""});
  return cells;
}

/// Our rows of a sequence, then the published ones.
std::vector<std::vector<std::string>> table_of(const View& view, const std::string& sequence) {
  std::vector<std::vector<std::string>> lines;
  for (const BenchmarkRow& row : view.rows) {
    if (row.sequence == sequence) lines.push_back(row_cells(view, row));
  }
  const NamedDataset* const dataset = find_dataset(view.benchmark.settings.dataset);
  if (dataset == nullptr) return lines;
  for (const PublishedMethod& method : published_methods(dataset->dataset)) {
    if (const PublishedFigure* figure = find_figure(method, sequence))
      lines.push_back(published_cells(view, method, *figure));
  }
  return lines;
}

/// The sequences in the order of the rows; the mean comes last.
std::vector<std::string> sequences_of(const View& view) {
  std::vector<std::string> sequences;
  for (const BenchmarkRow& row : view.rows) {
    if (std::ranges::find(sequences, row.sequence) == sequences.end()) sequences.push_back(row.sequence);
  }
  return sequences;
}

std::vector<std::string> notes_of(const View& view) {
  std::vector<std::string> notes = view.benchmark.notes;
  if (!view.benchmark.complete) notes.emplace_back("incomplete: the same command continues");
  if (const std::uint64_t frames = view.benchmark.settings.frames; frames > 0)
    notes.push_back(fmt::format("only {} frames of each sequence: published figures are of all", frames));
  if (view.benchmark.jobs > 1)
    notes.push_back(fmt::format("{} runs at a time: the ms are larger than those of a run alone", view.benchmark.jobs));
  for (const BenchmarkRow& row : view.rows) {
    if (row.failed > 0)
      notes.push_back(
          fmt::format("{}, {}: {} of {} runs failed: {}", row.sequence, row.mode, row.failed, row.runs, row.failure));
  }
  for (const LeftOut& one : view.benchmark.left_out) notes.push_back(one.folder + " is left out: " + one.reason);
  return notes;
}

/// Whose figures stand beside ours.
std::string sources_section(const View& view) {
  const NamedDataset* const dataset = find_dataset(view.benchmark.settings.dataset);
  const std::vector<PublishedMethod> methods =
      dataset == nullptr ? std::vector<PublishedMethod>{} : published_methods(dataset->dataset);
  if (methods.empty())
    return html::section("Published figures", "", html::list({"None are at hand for this dataset."}));
  html::Table table{{"source", "method", "alignment", "runs on"}, {}};
  for (const PublishedMethod& method : methods)
    table.rows.push_back({fmt::format("[{}] {}", method.number, method.source), method.method,
                          to_string(method.alignment), to_string(method.hardware)});
  return html::section("Published figures",
                       "Sim(3) also fits the scale, which makes errors smaller; ours are aligned with SE(3). Authors "
                       "choose runs, machines and rates differently: compare orders of magnitude. -: not stated.",
                       html::table(table));
}

}  // namespace

std::string benchmark_text(const Benchmark& benchmark, const Benchmark* before) {
  const View view = view_of(benchmark, before, true);
  std::string text;
  for (const std::string& sequence : sequences_of(view)) {
    std::vector<std::vector<std::string>> lines = table_of(view, sequence);
    lines.insert(lines.begin(), head(view));
    text += "\n" + sequence + "\n" + aligned_table(lines);
  }
  for (const std::string& note : notes_of(view)) text += "  note: " + note + "\n";
  return text;
}

std::string benchmark_html(const Benchmark& benchmark, const Benchmark* before) {
  const View view = view_of(benchmark, before, false);
  const BenchmarkSettings& settings = benchmark.settings;
  std::string body = html::badges({{"version", settings.version},
                                   {"build", settings.build},
                                   {"detector", settings.detector},
                                   {"frames", settings.frames == 0 ? "all" : fmt::format("{}", settings.frames)}});
  if (const std::vector<std::string> notes = notes_of(view); !notes.empty())
    body += html::section("Notes", "", html::list(notes));
  for (const std::string& sequence : sequences_of(view)) {
    const std::string note =
        sequence == kMeanName
            ? "Of the sequences over which publications give the mean."
            : "ATE: median (best–worst run); coverage: least; the others: median. ms: a frame in "
              "filter and slam, without the detector. States: ok / doubtful / odometry / predicted / lost. "
              "How: alignment, what it runs on, source [n] below.";
    body += html::section(sequence, note,
                          "<div style=\"overflow-x:auto;white-space:nowrap\">" +
                              html::table({head(view), table_of(view, sequence)}) + "</div>\n");
  }
  const NamedDataset* const dataset = find_dataset(settings.dataset);
  return html::page("RTD-SLAM benchmark", dataset == nullptr ? settings.dataset : dataset->title,
                    body + sources_section(view));
}

}  // namespace rtd::eval
