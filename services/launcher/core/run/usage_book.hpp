// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "services/evaluation/record/run_record.hpp"
#include "services/launcher/core/run/supervisor.hpp"

namespace rtd::launcher {

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
  void set(const std::string& process, const eval::ProcessUsage& usage) { entries_[process] = {usage, true}; }
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

}  // namespace rtd::launcher
