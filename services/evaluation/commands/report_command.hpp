// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace rtd::eval {

struct ReportOptions {
  std::string folder;  ///< what `rtd run --out` wrote
  bool quiet = false;  ///< no table
};
void add_report_command(CLI::App& parent, ReportOptions& options);

/// Writes report.json and report.html of a run and prints the table that `rtd run` ends with. `go_on` is asked while
/// the source is read or rendered again for the true masks: false stops that, and the report says on how many frames
/// the judgement rests. Returns the exit code: 0; 1 when a report cannot be written; 2 when run.json cannot be read.
int run_report(const ReportOptions& options, const std::function<bool()>& go_on, std::ostream& out, std::ostream& err);

struct CompareOptions {
  std::vector<std::string> folders, labels;
  std::string page;  ///< HTML file to write
};
void add_compare_command(CLI::App& parent, CompareOptions& options);

/// Writes one page with several runs of the same source next to each other and prints their errors. Exit codes as
/// above.
int run_compare(const CompareOptions& options, std::ostream& out, std::ostream& err);

}  // namespace rtd::eval
