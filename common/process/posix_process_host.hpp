// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/process/process_host.hpp"
#include "common/service/command_line.hpp"

namespace rtd::process {

/// Where children say that their work continues. They do it as under systemd (Type=notify, WatchdogSec=), so that a
/// service has one way to do it (service::SystemdLink). Belongs to one thread.
class NotifySocket {
 public:
  /// Throws ProcessError when the system has no socket left.
  NotifySocket();
  ~NotifySocket();
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  int fd() const { return fd_; }  ///< readable when a child has said something
  /// The environment of a child: that of this process, with the socket and the longest silence in it.
  std::vector<std::string> environment(std::chrono::microseconds longest_silence) const;
  /// Passes on everything that was said, e.g. "READY=1". The kernel vouches for the sender.
  void read(const std::function<void(ProcessId sender, std::string_view text)>& on_message) const;

 private:
  const int fd_;
};

/// Splits a byte stream into lines. A line longer than 4096 bytes comes in pieces.
class LineSplitter {
 public:
  /// Calls `on_line` for every line that `bytes` completes (without its newline).
  void feed(std::string_view bytes, const std::function<void(const std::string&)>& on_line);
  /// Passes on the rest that has no newline.
  void finish(const std::function<void(const std::string&)>& on_line);

 private:
  std::string rest_;
};

/// Child processes of this process. Each is the leader of its own process group, so that Ctrl-C of the terminal reaches
/// only the launcher; the kernel sends it SIGTERM when the launcher dies. stdin is /dev/null; stdout and stderr come
/// back line by line through on_line. Belongs to one thread, which must outlive the children.
class PosixProcessHost : public ProcessHost {
 public:
  using OnLine = std::function<void(const std::string& name, const std::string& line)>;

  /// Children that know systemd's watchdog say at least so often that their work continues (signs_of_life()). 0: they
  /// are not asked to.
  explicit PosixProcessHost(OnLine on_line, std::chrono::milliseconds longest_silence = {});
  ~PosixProcessHost() override;
  PosixProcessHost(const PosixProcessHost&) = delete;
  PosixProcessHost& operator=(const PosixProcessHost&) = delete;

  ProcessId start(const ProcessSpec& spec) override;
  std::optional<ProcessExit> poll_exit(ProcessId process) override;
  void terminate(ProcessId process) override;
  void kill(ProcessId process) override;
  std::uint64_t signs_of_life(ProcessId process) const override;
  std::chrono::milliseconds waited_for_processor(ProcessId process) const override;

  /// Waits until a child writes or ends, `wake_fd` becomes readable (-1: none) or the time is over; passes on complete
  /// lines.
  void wait(std::chrono::milliseconds timeout, int wake_fd = -1);

 private:
  struct Child {
    std::string name;
    int output_fd = -1;
    LineSplitter lines;
    std::uint64_t signs_of_life = 0;
    bool ending = false;
  };
  void receive(ProcessId sender, std::string_view text);
  void read_output(Child& child);
  void close_output(Child& child);

  OnLine on_line_;
  std::chrono::milliseconds longest_silence_;
  std::optional<NotifySocket> signs_;
  std::map<ProcessId, Child> children_;
};

/// Runs a command to its end. The first signal that arrives meanwhile is passed on as SIGTERM, the second kills it.
ProcessExit run_to_end(const ProcessSpec& spec, service::InterruptSignals& signals,
                       const PosixProcessHost::OnLine& on_line);

}  // namespace rtd::process
