// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

/// What the heap holds, in builds with AddressSanitizer; always 0 in others.
namespace rtd::testing {

/// Starts to watch; once, before the first input.
void watch_allocations();
/// Most bytes held at once since the last call, above what was held then.
std::size_t peak_allocation();

}  // namespace rtd::testing
