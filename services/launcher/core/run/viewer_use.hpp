// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace rtd::launcher {

/// How a run or a replay goes together with the page that shows it.
struct ViewerUse {
  bool shown = false;
  bool waits = true;  ///< a recording is played when the first page is open
  bool stays = true;  ///< until Ctrl-C, after the run
};

/// What follows `--viewer=`, with commas: "stay" or "true" (what an option without a value has), "now": does not wait;
/// "exit": does not stay. Empty for other words.
std::optional<ViewerUse> parse_viewer_use(const std::string& words);

/// What to write instead of these words.
std::string viewer_use_problem(const std::string& words);

}  // namespace rtd::launcher
