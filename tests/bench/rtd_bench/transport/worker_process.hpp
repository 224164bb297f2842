// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace rtd::bench {

/// A process that runs this executable again; what it writes to stdout is read at its end. Killed with this object.
class WorkerProcess {
 public:
  /// Throws std::runtime_error when it cannot be started.
  explicit WorkerProcess(const std::vector<std::string>& arguments);
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  struct End {
    int code = -1;  ///< exit code; -1: killed, or not ended in time
    std::string output;
  };
  void ask_to_end() const;  ///< SIGTERM
  /// Waits for the end, then kills.
  End finish(std::chrono::seconds timeout);

 private:
  pid_t pid_ = 0;
  int output_ = -1;
};

}  // namespace rtd::bench
