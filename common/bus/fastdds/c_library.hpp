// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::bus::fastdds {

/// Does nothing but make the linker take robust_locks.cpp. Its functions stand before those of the C library of the
/// same name and make every lock in shared memory robust, as Fast DDS 2.9 does not: a lock whose owner was killed is
/// free at once. Otherwise each process that sends something to the killed one waits for the lock for a second, and
/// with it its discovery, and a reader of frames may throw or wait forever. Only the state that a lock of Fast DDS
/// guards for some microseconds may then be unfinished: an entry of a queue or a counter of waiting threads.
///
/// Not with AddressSanitizer or ThreadSanitizer, which have functions of these names themselves.
void link_robust_locks() noexcept;

}  // namespace rtd::bus::fastdds
