// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <iostream>

#include "common/service/command_line.hpp"
#include "services/evaluation/commands/eval_command.hpp"
#include "services/evaluation/commands/experiment_command.hpp"
#include "services/evaluation/commands/report_command.hpp"
#include "services/evaluation/detector/eval_detector_command.hpp"

namespace {

using namespace rtd;

struct Requests {
  eval::EvalOptions trajectory;
  eval::EvalDetectorOptions detector;
  eval::ExperimentOptions ablate, benchmark;
  eval::ReportOptions report;
  eval::CompareOptions compare;
};

int report(const eval::ReportOptions& options) {
  service::InterruptSignals signals;
  bool go_on = true;
  return eval::run_report(
      options, [&] { return go_on = go_on && signals.take() == 0; }, std::cout, std::cerr);
}

int dispatch(const CLI::App& app, const Requests& requests) {
  if (app.got_subcommand("trajectory")) return eval::run_eval(requests.trajectory, std::cout, std::cerr);
  if (app.got_subcommand("detector")) return eval::run_eval_detector(requests.detector, std::cout, std::cerr);
  if (app.got_subcommand("ablate")) return eval::run_experiment(requests.ablate);
  if (app.got_subcommand("benchmark")) return eval::run_experiment(requests.benchmark);
  if (app.got_subcommand("report")) return report(requests.report);
  return eval::run_compare(requests.compare, std::cout, std::cerr);
}

}  // namespace

int main(int argc, char** argv) {
  Requests requests;
  CLI::App app{"Accuracy of trajectories and detectors, ablations, benchmarks, and the reports of runs", "rtd-eval"};
  app.require_subcommand(1);
  eval::add_eval_command(app, requests.trajectory);
  eval::add_eval_detector_command(app, requests.detector);
  eval::add_ablate_command(app, requests.ablate);
  eval::add_benchmark_command(app, requests.benchmark);
  eval::add_report_command(app, requests.report);
  eval::add_compare_command(app, requests.compare);
  return service::run_command(app, argc, argv, [&] { return dispatch(app, requests); });
}
