// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/evaluation/commands/experiment_command.hpp"
#include "services/evaluation/core/experiment/experiment.hpp"

namespace rtd::eval {

/// Subjects, variants and settings. Sequences in another layout than TUM's are prepared below the folder for results.
/// Throws service::ConfigError and camera::SourceError.
Experiment plan_experiment(const ExperimentOptions& options);

struct PlannedRun {
  Subject subject;
  Variant variant;
  int run = 1;
  std::string folder;  ///< below the one for results
};

/// What `experiment` does not have yet. The first runs of everything come first, so that the table is soon complete.
std::vector<PlannedRun> missing_runs(const ExperimentOptions& options, const Experiment& experiment);

/// Features of a frame in this run of a benchmark: one more or less changes a trajectory by tens of percent. 800 to
/// 1200; the first run is the plain one.
int feature_count_of(int run);

/// `rtd run` for it. Runs next to each other, one a place, are in their own DDS domains.
std::vector<std::string> run_command(const ExperimentOptions& options, const PlannedRun& planned, int place);

}  // namespace rtd::eval
