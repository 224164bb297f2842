// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace rtd::bus {

/// A DDS file in shared memory, and why it was left there; the reason is empty when it was removed.
struct ShmFile {
  std::string name;
  std::uint64_t bytes = 0;  ///< of memory that it occupies
  std::string reason;
};

struct CleanReport {
  std::vector<ShmFile> removed;
  std::vector<ShmFile> left;  ///< in use, too young, or not ours to remove
  std::uint64_t removed_bytes() const;
};

struct CleanOptions {
  std::string shm_dir = "/dev/shm", proc_dir = "/proc";
  std::chrono::seconds min_age{2};  ///< younger files may belong to a process that is just starting
  bool dry_run = false;             ///< only report what would be removed
};

/// Removes what killed DDS processes left in shared memory and in its folders of rings (ring_folder.hpp): files with
/// the names of our vendors that no living process maps, holds open or has locked, and empty folders of rings. Left are
/// files of a process that may not be looked at, and everything when this process shares /dev/shm with processes that
/// it cannot see (a container with the host's IPC but its own PIDs). Processes that clean at the same time take turns.
/// Never throws; 0.1 ms without such files, else about 5 ms for 100 processes.
CleanReport remove_shm_leftovers(const CleanOptions& options = {});

}  // namespace rtd::bus
