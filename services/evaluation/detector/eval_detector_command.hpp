// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "services/evaluation/detector/eval_detector_options.hpp"

namespace CLI {
class App;
}

namespace rtd::launcher {

/// Adds the subcommand `eval-detector` to `parent`; parsing fills `options`, which must outlive `parent`.
CLI::App* add_eval_detector_command(CLI::App& parent, EvalDetectorOptions& options);

/// Evaluates; tables to `out`, progress and what is wrong with the input to `err`. Returns the exit code: 0; 2 for
/// usage, folders or models that are missing or hold nothing to evaluate, and files that cannot be written.
int run_eval_detector(const EvalDetectorOptions& options, std::ostream& out, std::ostream& err);

}  // namespace rtd::launcher
