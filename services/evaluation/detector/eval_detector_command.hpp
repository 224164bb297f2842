// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace rtd::eval {

/// Degrees from, to and step of `--roll`; from = to: one angle.
struct RollRange {
  double from_deg = 0, to_deg = 0, step_deg = 15;
};

/// The command line of `rtd eval-detector`.
struct EvalDetectorOptions {
  std::string images;                          ///< folder
  std::string labels;                          ///< folder: average precision
  std::string masks;                           ///< folder: recall on masks
  std::string label_format = "auto";           ///< auto, yolo, voc
  std::string names_file;                      ///< class names, one per line; empty: those of the model
  std::vector<std::string> models;             ///< files or names; empty: the default model
  std::vector<std::string> engines = {"cpu"};  ///< each model with each of them (detector::parse_engine)
  std::string json;                            ///< file; empty = none
  double wanted_recall = 0.6;                  ///< of objects of the high motion level
  int step = 1;                                ///< every n-th image
  std::string class_name = "person";           ///< what the masks show
  std::string mask_model;                      ///< the network for masks, a file or a name; empty: boxes alone
  bool dark_masks = false;                     ///< objects are black in the masks
  std::vector<double> thresholds;              ///< for the masks; add_eval_detector_command() sets the detector's own
  RollRange roll;
};

/// Adds the subcommand `detector` to `parent`; parsing fills `options`, which must outlive `parent`.
CLI::App* add_eval_detector_command(CLI::App& parent, EvalDetectorOptions& options);

/// Evaluates. Writes tables to `out`, progress and problems with the input to `err`. Returns the exit code: 0; 2 for
/// wrong usage, folders, models, engines or devices that are missing, nothing to evaluate, and files that cannot be
/// written.
int run_eval_detector(const EvalDetectorOptions& options, std::ostream& out, std::ostream& err);

}  // namespace rtd::eval
