// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/viewer_use.hpp"

#include <sstream>

namespace rtd::launcher {

std::optional<ViewerUse> parse_viewer_use(const std::string& words) {
  ViewerUse use{.shown = true};
  std::istringstream rest(words);
  for (std::string word; std::getline(rest, word, ',');) {
    if (word == "now") {
      use.waits = false;
    } else if (word == "exit") {
      use.stays = false;
    } else if (word != "stay" && word != "true") {
      return std::nullopt;
    }
  }
  return use;
}

std::string viewer_use_problem(const std::string& words) {
  return "--viewer=" + words +
         ": write --viewer (a recording waits for the first page, the page stays until Ctrl-C), --viewer=now (no "
         "wait), --viewer=exit (the page ends with the run) or --viewer=now,exit";
}

}  // namespace rtd::launcher
