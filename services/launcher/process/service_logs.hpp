// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/io/byte_sink.hpp"
#include "services/launcher/core/run/terminal.hpp"

namespace rtd::launcher {

enum class LogLevel { kInfo, kWarning, kError };

/// The level of a service's log line: "12:34:56.789 warning slam event=..." or "rtd-slam: why it cannot run".
LogLevel level_of(std::string_view line);

/// Why a service refused to start: its last error line, else its last lines.
std::vector<std::string> reason_lines(const std::vector<std::string>& tail);

/// Writes the output of the services to FOLDER/<service>.log, shows warnings and errors, remembers the last lines.
class ServiceLogs {
 public:
  ServiceLogs(std::string folder, Terminal& terminal) : folder_(std::move(folder)), terminal_(terminal) {}

  void add(const std::string& service, const std::string& printed);
  /// The service's own reason for its end; empty when it was already shown.
  std::vector<std::string> reason(const std::string& service) const;
  std::vector<std::string> tail(const std::string& service) const;
  std::string path(const std::string& service) const { return folder_ + "/" + service + ".log"; }
  /// What the launcher has said itself: warnings of this event are only written.
  void hide(const std::string& event) { hidden_ = event; }
  /// From now on lines are only written, not shown.
  void mute() { muted_ = true; }

 private:
  struct Log {
    std::optional<io::FileSink> file;
    std::deque<std::string> tail;  ///< the last lines
    int shown = 0;
  };
  void show(const std::string& service, Log& log, const std::string& line);

  std::string folder_;
  Terminal& terminal_;
  std::map<std::string, Log> logs_;
  std::string hidden_;
  bool muted_ = false;
};

}  // namespace rtd::launcher
