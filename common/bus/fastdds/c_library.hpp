// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::bus::fastdds {

/// Does nothing but make the linker take c_library.cpp. Its functions stand before those of the C library of the same
/// name. Not with AddressSanitizer or ThreadSanitizer, which have functions of these names themselves.
///
/// Robust locks: every lock in shared memory is robust, as Fast DDS 2.9 does not make it: a lock whose owner was killed
/// is free at once. Otherwise each process that sends something to the killed one waits for the lock for a second, and
/// with it its discovery, and a reader of frames may throw or wait forever. Only the state that a lock of Fast DDS
/// guards for some microseconds may then be unfinished: an entry of a queue or a counter of waiting threads. So Fast
/// DDS waits for such a lock for as long as its owner lives. It would give up after a second, as on a host with far too
/// much work, by an exception that nothing catches where its threads note that they have handled a message or wait for
/// the next frame ("Interprocess mutex timeout"): the process would end.
///
/// Lock files: the last holder of a file removes it before unlocking it, and none locks a file without a name. Fast DDS
/// removes it after unlocking it, by name, and with it the lock that another process, or another thread of the same
/// one, has taken meanwhile. Others then take the port of a process that lives for one that was left, put another in
/// its place, and it receives nothing more: after a process had stood still, one time in fifty.
///
/// After a standstill: Fast DDS's timers, and nothing else, wait a little longer when they went off seconds late: the
/// process had been stopped. Otherwise every lease that ran out meanwhile ends at once, and Fast DDS 2.9 loses a
/// participant for good whose next announcement arrives in the microseconds in which it is forgotten. When all
/// processes of a robot continue at the same moment (a paused container), that is one pair of them in ten.
///
/// Segments of another user, who sends to us but does not let us open what was sent: a copy takes their place. Fast DDS
/// otherwise tries to open the segment for ever, at full speed, and no program is received any more. Only the first
/// message is in the copy; of the next ones Fast DDS sees that they are not there, and continues. All copies of a process
/// together have 64 MiB at most.
///
/// Trial files: before its first ring in a folder, Fast DDS makes and removes a small file in the working directory, to
/// see how much room its own data takes. It is in /dev/shm instead: not every working directory is writable.
void link_c_library_functions() noexcept;

}  // namespace rtd::bus::fastdds
