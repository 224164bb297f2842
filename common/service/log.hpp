// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rtd::service {

/// Sends spdlog to stderr as `LEVEL service event=... key=value`, one event a line: control characters of quoted texts
/// are escaped (io::printable()). Adapters only, cores return facts.
void init_logging(const std::string& service, const std::string& level);

/// Lets one message through per period and counts the rest, for events that can come with every frame. Thread-safe
/// enough for one caller per instance.
class RateLimit {
 public:
  explicit RateLimit(std::chrono::milliseconds period) : period_(period) {}
  /// True when the caller may log now; suppressed() then says how many were suppressed since the last time.
  bool pass();
  std::uint64_t suppressed() const { return last_suppressed_; }

 private:
  std::chrono::milliseconds period_;
  std::chrono::steady_clock::time_point last_{};
  std::uint64_t suppressed_ = 0, last_suppressed_ = 0;
};

/// The fields of a log line `event=frame_late frame=12 cause="a b"`, as the journal of systemd names them:
/// {"RTD_EVENT=frame_late", "RTD_FRAME=12", "RTD_CAUSE=a b"}. What is not KEY=VALUE is left out.
std::vector<std::string> journal_fields(std::string_view line);

/// Whether stderr of this process goes to the journal: systemd then sets JOURNAL_STREAM to its device and inode.
bool stderr_is_journal();

}  // namespace rtd::service
