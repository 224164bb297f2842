// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/service/monotonic_clock.hpp"

namespace rtd::viewer {

/// CLOCK_REALTIME, ms since 1970, as a page's clock.
inline double wall_clock_ms() {
  return 1e-6 * static_cast<double>(service::realtime_ns());
}

}  // namespace rtd::viewer
