// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace rtd::bus {

/// A file, whatever its name is now: device and inode.
using FileId = std::pair<std::uint64_t, std::uint64_t>;

/// A process whose files may not be seen, and which has the threads that a DDS process has.
struct UnreadableProcess {
  pid_t pid = 0;
  uid_t user = 0;
};

/// Who uses the files of shared memory on this host.
struct ShmUsers {
  std::set<FileId> in_use;                    ///< mapped or open
  std::vector<UnreadableProcess> unreadable;  ///< what these use is not known
};

/// The namespaces of the host itself; a container has others.
bool in_first_pid_namespace(const std::string& proc_dir = "/proc");
bool in_first_ipc_namespace(const std::string& proc_dir = "/proc");

/// Looks in all processes for the files that they map or hold open and whose name contains one of `name_parts`. A file
/// that was listed before the call and whose maker lives is found: descriptors are read before maps, and a maker maps
/// the file before it closes the descriptor. About 5 ms for 100 processes.
/// The init of the host never counts as a user, even where it may not be read.
ShmUsers find_shm_users(const std::vector<std::string>& name_parts, const std::string& proc_dir = "/proc");

}  // namespace rtd::bus
