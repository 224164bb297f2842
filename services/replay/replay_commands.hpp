// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "common/bus/commands.hpp"
#include "services/replay/core/player.hpp"

namespace rtd::replay {

/// log_time of the recording's first message, and of the first and last one that are played.
struct RecordedSpan {
  std::int64_t first_ns = 0, start_ns = 0, end_ns = 0;
};

/// The commands of a replay: replay/pause, replay/step, replay/seek and replay/speed. Each answer says where the replay
/// is then.
class ReplayCommands {
 public:
  /// `post` hands a request to the player; one that it drops is answered as failed.
  ReplayCommands(bus::Bus& bus, const RecordedSpan& span, std::function<void(Request)> post);

 private:
  bus::CommandAnswer ask(Request request, const char* what) const;
  bus::CommandAnswer seek(const std::string& argument) const;
  bus::CommandAnswer set_rate(const std::string& argument) const;

  const RecordedSpan span_;
  const std::function<void(Request)> post_;
  bus::CommandServer server_;  // last: it uses the others
};

}  // namespace rtd::replay
