// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace rtd::filter {

/// Processor cores that this process may use at most: the smallest quota of its control groups (cgroup v2 `cpu.max`, v1
/// `cpu.cfs_quota_us`), as containers and systemd's CPUQuota= set it, and the number of cores that it may run on. Reads
/// below `root`.
double usable_cores(const std::filesystem::path& root = "/");

}  // namespace rtd::filter
