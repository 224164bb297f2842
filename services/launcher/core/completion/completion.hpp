// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace rtd::launcher {

/// Where candidates come from. What a program says about itself in its help is the only list of its options, so that a
/// new option is completed without a change here.
struct CompletionSources {
  std::vector<std::string> commands;
  std::vector<std::string> services;  ///< whose keys `rtd run --set` takes
  std::vector<std::string> topics;    ///< names for `rtd topics echo` and `hz`
  /// The help of `rtd COMMAND [SUBCOMMAND]`; empty when there is none.
  std::function<std::string(const std::vector<std::string>& command)> help;
  /// What `rtd SERVICE --print-config` prints; empty when there is none.
  std::function<std::string(const std::string& service)> config;
};

/// The candidates for the last of `words`, which follow `rtd` on the command line: commands, options, their values, the
/// schemes of --source, the keys of --set, topics. Without a candidate the shell completes file names.
std::vector<std::string> complete(const std::vector<std::string>& words, const CompletionSources& sources);

}  // namespace rtd::launcher
