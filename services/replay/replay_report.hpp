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
struct Report {
  std::string file, outcome;
  struct Topic {
    std::string name, type;
    std::uint64_t sent = 0, refused = 0;
  };
  std::vector<Topic> topics;
  std::uint64_t sent = 0, refused = 0, resends = 0;
  std::uint64_t timed = 0;  ///< messages whose distance to the previous one was compared with the recording
  double timing_error_p50_ms = 0, timing_error_p99_ms = 0, timing_error_max_ms = 0;
  std::vector<std::string> problems;
};

Report report_of(const Player& player, const Outputs& outputs, const std::string& file, PlayOutcome outcome,
                 const mcap::Problems& problems);
std::string log_text(const Report& report);
nlohmann::ordered_json to_json(const Report& report);

/// Where the replay is, in one line that is rewritten; nothing without a terminal.
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

/// "12.3 of 61.3 s [####................] 1.00x, 1234 messages, paused"
std::string status_text(const PlayState& state, std::int64_t start_ns, std::int64_t end_ns);

}  // namespace rtd::replay
