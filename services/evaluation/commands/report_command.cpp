// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/commands/report_command.hpp"

#include <CLI/CLI.hpp>
#include <ostream>

#include "common/io/atomic_file.hpp"
#include "services/evaluation/commands/guarded.hpp"
#include "services/evaluation/core/report/report.hpp"

namespace rtd::eval {

void add_report_command(CLI::App& parent, ReportOptions& options) {
  CLI::App* command =
      parent.add_subcommand("report", "Write report.json, report.html and map.html of a run from its run.json");
  command->add_option("folder", options.folder, "Folder that 'rtd run --out' wrote")->required();
  command->add_flag("--quiet", options.quiet, "Print no table");
}

int run_report(const ReportOptions& options, const std::function<bool()>& go_on, std::ostream& out, std::ostream& err) {
  return guarded("rtd report", err, [&] {
    Run run = load_run(options.folder);
    judge_run(run, go_on);
    choose_trajectory(run, options.folder);
    const RunSummary summary = write_report(run, options.folder);
    if (!options.quiet) out << summary_text(run, summary, options.folder) << std::flush;
    return service::kOk;
  });
}

void add_compare_command(CLI::App& parent, CompareOptions& options) {
  CLI::App* command = parent.add_subcommand("compare", "Show several runs of the same source on one page");
  command->add_option("folders", options.folders, "Folders that 'rtd run --out' wrote; the first is the baseline")
      ->required();
  command->add_option("--label", options.labels, "Name of a run, one per folder (default: the folder)");
  command->add_option("--page", options.page, "HTML file to write")->required();
}

int run_compare(const CompareOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("rtd compare", err, [&] {
    std::vector<ComparedRun> runs;
    for (const std::string& folder : options.folders) {
      const bool labelled = runs.size() < options.labels.size();
      runs.push_back({labelled ? options.labels[runs.size()] : folder, load_run(folder)});
      choose_trajectory(runs.back().run, folder);
      link_from(options.page, folder, runs.back().run);
    }
    io::write_file(options.page, comparison_html(runs));
    out << comparison_text(runs) << std::flush;
    return service::kOk;
  });
}

}  // namespace rtd::eval
