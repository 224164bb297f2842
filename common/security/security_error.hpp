// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace rtd::security {

/// A keystore cannot be made or used; what() names file or enclave, cause and fix.
class SecurityError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rtd::security
