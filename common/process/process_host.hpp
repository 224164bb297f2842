// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

struct rusage;

namespace rtd::process {

/// A process could not be started; what() names the executable and the reason.
class ProcessError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

using ProcessId = std::int64_t;

/// How a process ended and what it used.
struct ProcessExit {
  int code = 0;    ///< exit code, meaningful when signal == 0
  int signal = 0;  ///< the signal that ended it, 0 = it exited by itself
  double cpu_s = 0;
  double peak_rss_mb = 0;
  bool interrupted = false;  ///< run_to_end() passed a signal on

  bool clean() const { return code == 0 && signal == 0; }
};

/// "exit code 1" or "killed by signal 9 (KILL)".
std::string describe(const ProcessExit& exit);

struct ProcessSpec {
  std::string name;                  ///< for messages and logs
  std::vector<std::string> command;  ///< path of the executable and its arguments
  int niceness = 0;            ///< added to the launcher's own: 0 = the same priority, 19 = only idle processor time
  bool reads_signals = false;  ///< as service::InterruptSignals: SIGTERM does not end it before it does so
};

/// Starts and ends processes. Injected, so that the supervisor is tested without an operating system.
class ProcessHost {
 public:
  virtual ~ProcessHost() = default;
  /// Throws ProcessError when the executable cannot be run.
  virtual ProcessId start(const ProcessSpec& spec) = 0;
  /// How the process ended; empty while it runs. Returned once, then the id is gone.
  virtual std::optional<ProcessExit> poll_exit(ProcessId process) = 0;
  virtual void terminate(ProcessId process) = 0;  ///< asks (SIGTERM)
  virtual void kill(ProcessId process) = 0;       ///< forces (SIGKILL)
  /// How often the process has said that its work continues. 0: it has not begun, is about to end, or never says it.
  virtual std::uint64_t signs_of_life(ProcessId process) const = 0;
  /// For how long its threads together were ready to work and had to wait for a processor; 0 where the system does not
  /// say. One that hangs waits for something else.
  virtual std::chrono::milliseconds waited_for_processor(ProcessId process) const = 0;
};

/// User and system time of a process.
double cpu_s(const rusage& usage);

}  // namespace rtd::process
