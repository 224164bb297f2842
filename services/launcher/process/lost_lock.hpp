// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace rtd::launcher {

/// Fast DDS 2.9 ends a process when another one holds a lock in memory that both share for more than a second, as on a
/// host with far too much work: a thread of its own throws "Interprocess mutex timeout". A launcher that ended would
/// take the whole run with it. From now on such a thread of this process stands still instead, for ever, and what it
/// read is no longer read (docs/topics.md).
void survive_lost_locks();

/// How many threads stand still. Their process must end with std::_Exit(). Thread-safe.
std::uint64_t lost_locks();

}  // namespace rtd::launcher
