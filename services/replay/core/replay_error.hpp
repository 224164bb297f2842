// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace rtd::replay {

/// The recording or what was asked of it cannot be used; what() names the value, the cause and the fix.
class ReplayError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rtd::replay
