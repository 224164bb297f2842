// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/process/usage_registry.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

namespace rtd::launcher {

void UsageRegistry::add_sample(const std::string& service, double peak_rss_mb, double cpu_s) {
  if (peak_rss_mb < 0) return;
  Entry& entry = entries_[service];
  entry.running_cpu_s = cpu_s;
  entry.usage.peak_rss_mb = entry.sampled ? std::max(entry.usage.peak_rss_mb, peak_rss_mb) : peak_rss_mb;
  entry.sampled = true;
}

void UsageRegistry::add_exit(const std::string& service, const process::ProcessExit& exit) {
  Entry& entry = entries_[service];
  entry.usage.cpu_s += exit.cpu_s;
  entry.running_cpu_s = 0;
  if (!entry.sampled) entry.usage.peak_rss_mb = std::max(entry.usage.peak_rss_mb, exit.peak_rss_mb);
}

void UsageRegistry::add_death(const std::string& service, const std::string& how) {
  run_record::ProcessUsage& usage = entries_[service].usage;
  ++usage.deaths;
  usage.died = how;
}

std::map<std::string, run_record::ProcessUsage> UsageRegistry::usage() const {
  std::map<std::string, run_record::ProcessUsage> result;
  for (const auto& [name, entry] : entries_) {
    result[name] = entry.usage;
    result[name].cpu_s += entry.running_cpu_s;
  }
  return result;
}

double peak_rss_mb(const std::string& proc_status) {
  const std::string key = "VmHWM:";
  const std::size_t at = proc_status.find(key);
  if (at == std::string::npos) return -1;
  std::istringstream value(proc_status.substr(at + key.size()));
  double kib = 0;
  return value >> kib ? kib / 1024.0 : -1;
}

double cpu_s(const std::string& proc_stat) {
  constexpr int kFieldsBefore = 11;  // from the state, after the name in parentheses, to utime and stime
  std::istringstream fields(proc_stat.substr(std::min(proc_stat.size(), proc_stat.rfind(')') + 1)));
  std::string other;
  for (int i = 0; i < kFieldsBefore; ++i) fields >> other;
  double user_ticks = 0, system_ticks = 0;
  fields >> user_ticks >> system_ticks;
  return (user_ticks + system_ticks) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

run_record::ProcessUsage own_usage() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return {process::cpu_s(usage), static_cast<double>(usage.ru_maxrss) / 1024.0, 0};
}

}  // namespace rtd::launcher
