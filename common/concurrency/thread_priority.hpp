// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/resource.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace rtd::concurrency {

/// Makes the calling thread `by` nicer (on Linux niceness belongs to the thread): it yields to threads whose work is
/// more urgent. At most 19; what the system refuses is left as it was.
inline void lower_thread_priority(int by) {
  setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + by);
}

/// The same for every thread that the process has now; those made later inherit it from who makes them.
inline void lower_process_priority(int by) {
  std::error_code error;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", error)) {
    const auto thread = static_cast<id_t>(std::atoi(task.path().filename().c_str()));
    setpriority(PRIO_PROCESS, thread, getpriority(PRIO_PROCESS, thread) + by);
  }
}

}  // namespace rtd::concurrency
