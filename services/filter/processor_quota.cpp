// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/processor_quota.hpp"

#include <algorithm>
#include <limits>
#include <sstream>
#include <string>
#include <thread>

#include "common/io/input_file.hpp"
#include "common/io/text.hpp"

namespace rtd::filter {
namespace fs = std::filesystem;
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

double cores_of(const std::string& quota, const std::string& period) {
  const auto quota_us = io::parse_number(quota), period_us = io::parse_number(period);
  return quota_us && period_us && *quota_us > 0 && *period_us > 0 ? *quota_us / *period_us : kNoLimit;
}

std::string first_word(const fs::path& file) {
  std::istringstream text(io::try_read_file(file, io::kKernelText).value_or(""));
  std::string word;
  text >> word;
  return word;
}

double quota_of(const fs::path& group) {
  std::istringstream text(io::try_read_file(group / "cpu.max", io::kKernelText).value_or(""));
  std::string quota, period;
  text >> quota >> period;  // "max 100000": parse_number() finds no number
  return std::min(cores_of(quota, period),
                  cores_of(first_word(group / "cpu.cfs_quota_us"), first_word(group / "cpu.cfs_period_us")));
}

/// Of a group and all that it lies in.
double smallest_quota(const fs::path& mount, const fs::path& group) {
  double cores = quota_of(mount);
  fs::path place = mount;
  for (const fs::path& name : group.relative_path()) cores = std::min(cores, quota_of(place /= name));
  return cores;
}

}  // namespace

double usable_cores(const fs::path& root) {
  double cores = std::max(1U, std::thread::hardware_concurrency());
  std::istringstream groups(io::try_read_file(root / "proc/self/cgroup", io::kKernelText).value_or(""));
  const fs::path mounts = root / "sys/fs/cgroup";
  for (std::string line; std::getline(groups, line);) {  // "4:cpu,cpuacct:/path" or, version 2, "0::/path"
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1), group = line.substr(second + 1);
    for (const fs::path& mount : {mounts / controllers, mounts / "cpu"}) {
      if (controllers.empty() || ("," + controllers + ",").find(",cpu,") != std::string::npos)
        cores = std::min(cores, smallest_quota(mount, group));
      if (controllers.empty()) break;
    }
  }
  return cores;
}

}  // namespace rtd::filter
