// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rtd::service {

/// Sends spdlog to stderr as `LEVEL service event=... key=value`, one event a line: control characters of quoted texts
/// are escaped (io::printable()). Warnings and errors that repeat are grouped (RepeatedEvents). Adapters only, cores
/// return facts.
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

/// Groups warnings and errors that differ in their numbers only: the first is written, those of the next ten seconds
/// are counted, and the one after says how many these were and since when. Not thread-safe.
class RepeatedEvents {
 public:
  using Time = std::chrono::system_clock::time_point;
  static constexpr std::chrono::seconds kGroup{10};
  static constexpr std::size_t kMaxKinds = 256;

  /// What is added to the line, "" or " repeated=7 first=12:00:01"; empty: it is only counted.
  std::optional<std::string> note(std::string_view line, Time now);
  /// The newest line of each kind that was only counted, with number, first and last. They are forgotten.
  std::vector<std::string> take_counted();

 private:
  struct Kind {
    Time written{}, first{}, last{};
    std::uint64_t counted = 0;
    std::string newest;
  };
  static std::string summary(const Kind& kind);
  std::map<std::string, Kind> kinds_;
};

/// Writes what RepeatedEvents has only counted: at the end of a process.
void log_repeated_events();

/// The fields of a log line `event=frame_late frame=12 cause="a b"`, as the journal of systemd names them:
/// {"RTD_EVENT=frame_late", "RTD_FRAME=12", "RTD_CAUSE=a b"}. What is not KEY=VALUE is left out.
std::vector<std::string> journal_fields(std::string_view line);

/// Whether stderr of this process goes to the journal: systemd then sets JOURNAL_STREAM to its device and inode.
bool stderr_is_journal();

}  // namespace rtd::service
