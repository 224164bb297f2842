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

#include "common/service/command_line.hpp"
#include "services/evaluation/record/run_record.hpp"
#include "services/launcher/core/run/supervisor.hpp"
#include "services/launcher/process/notify_socket.hpp"

namespace rtd::launcher {

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

  /// Children that know systemd's watchdog say at least so often that their work goes on (signs_of_life()). 0: they are
  /// not asked to.
  explicit PosixProcessHost(OnLine on_line, std::chrono::milliseconds longest_silence = {});
  ~PosixProcessHost() override;
  PosixProcessHost(const PosixProcessHost&) = delete;
  PosixProcessHost& operator=(const PosixProcessHost&) = delete;

  ProcessId start(const ProcessSpec& spec) override;
  std::optional<ProcessExit> poll_exit(ProcessId process) override;
  void terminate(ProcessId process) override;
  void kill(ProcessId process) override;
  std::uint64_t signs_of_life(ProcessId process) const override;

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
  void hear(ProcessId sender, std::string_view text);
  void read_output(Child& child);
  void close_output(Child& child);

  OnLine on_line_;
  std::chrono::milliseconds longest_silence_;
  std::optional<NotifySocket> signs_;
  std::map<ProcessId, Child> children_;
};

/// Runs a command to its end. Each signal that arrives meanwhile is passed on as SIGTERM.
ProcessExit run_to_end(const ProcessSpec& spec, service::InterruptSignals& signals,
                       const PosixProcessHost::OnLine& on_line);

/// Adds up what each service used, over all its lives.
///
/// CPU time comes from the kernel's final account. Peak memory comes from samples of VmHWM: the final account
/// (ru_maxrss) also contains the launcher's own memory at the time of the fork, so it only counts for a process too
/// short-lived to be sampled.
class UsageBook {
 public:
  void add_sample(const std::string& service, double peak_rss_mb);
  void add_exit(const std::string& service, const ProcessExit& exit);
  void add_restart(const std::string& service) { ++entries_[service].usage.restarts; }
  std::map<std::string, eval::ProcessUsage> usage() const;

 private:
  struct Entry {
    eval::ProcessUsage usage;
    bool sampled = false;
  };
  std::map<std::string, Entry> entries_;
};

/// Peak resident memory in MB (VmHWM), from the text of /proc/PID/status; -1 when absent (the process is ending).
double peak_rss_mb(const std::string& proc_status);
/// Of this process so far.
eval::ProcessUsage own_usage();

}  // namespace rtd::launcher
