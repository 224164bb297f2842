// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace rtd::detector {

/// The network cannot be used; what() names the file, the cause and the fix.
class ModelError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rtd::detector
