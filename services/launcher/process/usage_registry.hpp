// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "common/process/process_host.hpp"
#include "common/run_record/run_record.hpp"

namespace rtd::launcher {

/// Adds up what each service used, over all its lives.
///
/// CPU time comes from the kernel's final account, of a process that still runs from its last sample. Peak memory comes
/// from samples of VmHWM: the final account (ru_maxrss) also contains the launcher's own memory at the time of the
/// fork, so it only counts for a process too short-lived to be sampled.
class UsageRegistry {
 public:
  void add_sample(const std::string& service, double peak_rss_mb, double cpu_s);
  void add_exit(const std::string& service, const process::ProcessExit& exit);
  /// "died: killed by signal 9 (SIGKILL)".
  void add_death(const std::string& service, const std::string& how);
  void add_restart(const std::string& service) { ++entries_[service].usage.restarts; }
  std::map<std::string, run_record::ProcessUsage> usage() const;

 private:
  struct Entry {
    run_record::ProcessUsage usage;
    bool sampled = false;
    double running_cpu_s = 0;  ///< of its present life
  };
  std::map<std::string, Entry> entries_;
};

/// Peak resident memory in MB (VmHWM), from the text of /proc/PID/status; -1 when absent (the process is ending).
double peak_rss_mb(const std::string& proc_status);
/// CPU time so far, from the text of /proc/PID/stat; 0 when it cannot be read.
double cpu_s(const std::string& proc_stat);
/// Of this process so far.
run_record::ProcessUsage own_usage();

}  // namespace rtd::launcher
