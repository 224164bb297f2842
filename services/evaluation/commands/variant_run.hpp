// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/evaluation/commands/ablate_command.hpp"
#include "services/evaluation/core/ablation/ablation_result.hpp"

namespace rtd::launcher {

/// What `rtd-<service> --print-config` prints. Throws service::ConfigError when it cannot be run.
std::string printed_config(const std::string& service);

/// One run of the experiment.
struct VariantTask {
  std::string source, source_name;
  Variant variant;
  int run = 1;
};
struct VariantRun {
  Measurement measurement;
  bool interrupted = false;
  bool reused = false;  ///< measured by an earlier ablation
};

/// Runs it in OUT/<source>/<variant>/<run>, or takes what is there when it may be kept (--resume) and the settings are
/// the same. A run that fails is a measurement with a reason. Throws service::ConfigError when nothing could be
/// started.
VariantRun run_variant(const AblateOptions& options, const VariantTask& task);

}  // namespace rtd::launcher
