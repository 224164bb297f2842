// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/commands/eval_command.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <stdexcept>

#include "common/service/exit_code.hpp"
#include "services/evaluation/commands/eval_table.hpp"
#include "services/evaluation/core/report/trajectory_plot.hpp"
#include "services/evaluation/core/trajectory/evaluation_json.hpp"

namespace rtd::launcher {
namespace {

struct Inputs {
  eval::Trajectory estimate, groundtruth;
  std::optional<std::vector<std::int64_t>> frames_ns;
};

Inputs read_inputs(const EvalOptions& options) {
  Inputs inputs{eval::read_tum_trajectory(options.estimate), eval::read_tum_trajectory(options.groundtruth), {}};
  if (!options.frames.empty()) inputs.frames_ns = eval::read_frame_stamps(options.frames);
  return inputs;
}

eval::EvaluationOptions evaluation_options(const EvalOptions& options) {
  eval::EvaluationOptions result;
  result.association = {options.max_difference_s, options.offset_s};
  result.alignment = options.scale ? eval::AlignmentKind::kSimilarity : eval::AlignmentKind::kRigid;
  return result;
}

/// The plot cannot be written; what() names the file and the fix.
class PlotError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

void write_plot(const eval::Evaluation& evaluation, const Inputs& inputs, const EvalOptions& options) {
  const std::filesystem::path path = options.plot;
  if (path.extension() != ".svg") {
    throw PlotError("--plot " + options.plot + ": only SVG is written; give the file the ending .svg");
  }
  eval::Trajectory groundtruth = inputs.groundtruth;  // on the estimate's clock, which is the plot's
  const std::int64_t offset_ns = std::llround(options.offset_s * 1e9);
  for (eval::StampedPose& pose : groundtruth) pose.stamp_ns -= offset_ns;
  std::ofstream output(path);
  output << evaluation_svg(evaluation.ate, groundtruth, std::filesystem::path(options.estimate).filename().string());
  output.flush();
  if (!output) throw PlotError("--plot " + options.plot + ": cannot be written; check that its folder exists");
}

}  // namespace

CLI::App* add_eval_command(CLI::App& parent, EvalOptions& options) {
  CLI::App* command = parent.add_subcommand("eval", "Compare a trajectory with its ground truth (both in TUM format)");
  command->add_option("estimate", options.estimate, "Trajectory to judge: stamp tx ty tz qx qy qz qw")->required();
  command->add_option("groundtruth", options.groundtruth, "Ground truth in the same format")->required();
  command->add_flag("--json", options.json, "Print JSON instead of a table");
  command->add_option("--plot", options.plot, "Write an SVG: both trajectories, error by colour and over time");
  command->add_flag("--scale", options.scale, "Also fit a scale (Sim(3), for monocular trajectories)");
  command->add_option("--max-difference", options.max_difference_s, "Largest time between poses of a pair [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--offset", options.offset_s, "Added to the stamps of the estimate [s]")->capture_default_str();
  command->add_option("--frames", options.frames, "Frame list (rgb.txt, associations.txt): coverage counts its frames");
  return command;
}

int run_eval(const EvalOptions& options, std::ostream& out, std::ostream& err) {
  try {
    const Inputs inputs = read_inputs(options);
    const eval::Evaluation evaluation =
        eval::evaluate(inputs.estimate, inputs.groundtruth, evaluation_options(options), inputs.frames_ns);
    if (evaluation.ate.error_m.count == 0) {
      err << explain_no_pairs(inputs.estimate, inputs.groundtruth, options);
      return service::kRunFailed;
    }
    if (!options.plot.empty()) write_plot(evaluation, inputs, options);
    if (options.json) {
      out << eval::to_json(evaluation).dump(2) << "\n";
    } else {
      out << evaluation_table(evaluation, options);
    }
    return service::kOk;
  } catch (const eval::TrajectoryError& error) {
    err << "rtd eval: " << error.what() << "\n";
    return service::kUsageOrConfig;
  } catch (const PlotError& error) {
    err << "rtd eval: " << error.what() << "\n";
    return service::kUsageOrConfig;
  }
}

}  // namespace rtd::launcher
