// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::bus::fastdds {

/// Does nothing but make the linker take standstill_guard.cpp. Its function stands before the C library's of the same
/// name and lets Fast DDS's timers, and nothing else, wait a little longer when they went off seconds late: the process
/// had been stopped. Otherwise every lease that ran out meanwhile ends at once, and Fast DDS 2.9 loses a participant
/// for good whose next announcement arrives in the microseconds in which it is forgotten. When all processes of a robot
/// continue at the same moment (a paused container), that is one pair of them in ten.
///
/// Not with AddressSanitizer or ThreadSanitizer, which have a function of this name themselves.
void link_standstill_guard() noexcept;

}  // namespace rtd::bus::fastdds
