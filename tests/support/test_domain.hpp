// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cstdint>

namespace rtd {

/// A DDS domain of this process's own, so that tests can run side by side: 1 to 60. Up to 101 a domain's ports
/// (7400 + 250 N) lie below those that Linux lends to any program, which would now and then be taken already.
inline std::uint32_t test_domain() {
  return 1 + static_cast<std::uint32_t>(getpid()) % 60;
}

}  // namespace rtd
