// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "services/replay/core/player.hpp"
#include "services/replay/outputs.hpp"

namespace rtd::replay {

/// What a replay was.
struct Report {
  std::string file, outcome;
  struct Topic {
    std::string name, type;
    std::uint64_t sent = 0, refused = 0;
  };
  std::vector<Topic> topics;
  std::uint64_t sent = 0, refused = 0, resends = 0;
  std::uint64_t timed = 0;  ///< messages whose distance to the one before was compared with the recording's
  double timing_error_p50_ms = 0, timing_error_p99_ms = 0, timing_error_max_ms = 0;
  std::vector<std::string> problems;
};

Report report_of(const Player& player, const Outputs& outputs, const std::string& file, PlayOutcome outcome,
                 const mcap::Problems& problems);
std::string log_text(const Report& report);
nlohmann::ordered_json to_json(const Report& report);

}  // namespace rtd::replay
