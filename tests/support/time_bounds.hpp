// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>

#include "tests/support/sanitizers.hpp"

namespace rtd::test_support {

/// Whether to check bounds that only a quiet machine keeps: with RTD_TIME_BOUNDS set, as `deploy/test.sh --all` does.
inline bool checks_time() {
  return !kSanitized && std::getenv("RTD_TIME_BOUNDS") != nullptr;
}

}  // namespace rtd::test_support
