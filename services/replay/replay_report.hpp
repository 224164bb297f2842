// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "services/replay/core/player.hpp"
#include "services/replay/outputs.hpp"

namespace rtd::replay {

/// The result of a replay.
nlohmann::ordered_json report_of(const Player& player, const Outputs& outputs, const std::string& file,
                                 PlayOutcome outcome, const mcap::Problems& problems);
/// Its figures, for the log.
std::string log_text(const nlohmann::ordered_json& report);

/// Where the replay is, in one line that is rewritten; nothing without a terminal:
/// "12.3 of 61.3 s [####................] 1.00x, 1234 messages, paused"
class StatusLine {
 public:
  StatusLine(std::int64_t start_ns, std::int64_t end_ns);
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;
  void show(const PlayState& state, std::int64_t now_ns);

 private:
  std::int64_t start_ns_, end_ns_, next_ns_ = 0;
  bool interactive_, paused_ = false;
};

}  // namespace rtd::replay
