// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "services/evaluation/core/trajectory/pose_file.hpp"

namespace CLI {
class App;
}

namespace rtd::eval {

/// The command line of `rtd eval`.
struct EvalOptions {
  std::vector<std::string> estimates;  ///< trajectories: read_pose_file()
  std::string groundtruth;             ///< likewise
  MissingStamps stamps;                ///< of those in KITTI's format
  std::string frames;  ///< frame list (rgb.txt, associations.txt) for the coverage; empty = ground truth's span
  std::string plot;    ///< write this SVG; empty = none
  double max_difference_s = 0.02;
  double offset_s = 0;
  std::optional<double> scene_depth_m;  ///< of the background
  bool scale = false;                   ///< Sim(3) instead of SE(3)
  bool json = false;
};

/// Adds the subcommand `trajectory` with its arguments to `parent`; parsing fills `options`, which must outlive
/// `parent`.
CLI::App* add_eval_command(CLI::App& parent, EvalOptions& options);

/// Evaluates each estimate. Writes the table or the JSON to `out`, errors and how to fix them to `err`.
/// Returns the exit code: 0; 1 when no poses of an estimate associate; 2 when a file is missing, malformed or cannot be
/// written; 3 when it has evaluated, but part of a recording is damaged and left out.
int run_eval(const EvalOptions& options, std::ostream& out, std::ostream& err);

}  // namespace rtd::eval
