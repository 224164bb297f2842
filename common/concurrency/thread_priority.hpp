// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/resource.h>

namespace rtd::concurrency {

/// Makes the calling thread `by` nicer (on Linux niceness belongs to the thread): it yields to threads whose work is
/// more urgent. At most 19; what the system refuses is left as it was.
inline void lower_thread_priority(int by) {
  const int own = getpriority(PRIO_PROCESS, 0);
  setpriority(PRIO_PROCESS, 0, own + by);
}

}  // namespace rtd::concurrency
