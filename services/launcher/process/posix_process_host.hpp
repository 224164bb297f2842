// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/service/command_line.hpp"
#include "services/launcher/core/run/log_tail.hpp"
#include "services/launcher/core/run/supervisor.hpp"

namespace rtd::launcher {

/// Child processes of this process. Each is the leader of its own process group, so that Ctrl-C of the terminal reaches
/// only the launcher; the kernel sends it SIGTERM when the launcher dies. stdin is /dev/null; stdout and stderr come
/// back line by line through on_line. Belongs to one thread, which must outlive the children.
class PosixProcessHost : public ProcessHost {
 public:
  using OnLine = std::function<void(const std::string& name, const std::string& line)>;

  explicit PosixProcessHost(OnLine on_line);
  ~PosixProcessHost() override;
  PosixProcessHost(const PosixProcessHost&) = delete;
  PosixProcessHost& operator=(const PosixProcessHost&) = delete;

  ProcessId start(const ProcessSpec& spec) override;
  std::optional<ProcessExit> poll_exit(ProcessId process) override;
  void terminate(ProcessId process) override;
  void kill(ProcessId process) override;

  /// Waits until a child writes or ends, `wake_fd` becomes readable (-1: none) or the time is over; passes on complete
  /// lines.
  void wait(std::chrono::milliseconds timeout, int wake_fd = -1);

 private:
  struct Child {
    std::string name;
    int output_fd = -1;
    LineSplitter lines;
  };
  void read_output(Child& child);
  void close_output(Child& child);

  OnLine on_line_;
  std::map<ProcessId, Child> children_;
};

/// Runs a command to its end. Each signal that arrives meanwhile is passed on as SIGTERM.
ProcessExit run_to_end(const ProcessSpec& spec, service::InterruptSignals& signals,
                       const PosixProcessHost::OnLine& on_line);

}  // namespace rtd::launcher
