// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "common/service/config.hpp"

namespace rtd::service {

/// Another process of this user is that service already; what() names it and the fix.
class AlreadyRuns : public ConfigError {
 public:
  using ConfigError::ConfigError;
};

/// What there is to be one of for a user on a host.
struct ServicePlace {
  std::string service;  ///< "slam"
  std::string robot;    ///< "" for one without a name
  std::uint32_t domain = 0;
  bool own_process_only = false;  ///< a domain of this process alone (bus::kInprocess)
};

/// Holds the place of a service until destroyed or until its process ends, however that ends. The kernel keeps it, a
/// Unix socket with an abstract name, so that no message, no other host and no other user can take or fake it, and no
/// clock decides who was first. The place of a process in another container or of another user is not seen.
class ServiceLock {
 public:
  /// Waits for so long for the place of one that just ends. Throws AlreadyRuns.
  explicit ServiceLock(const ServicePlace& place, std::chrono::milliseconds patience = std::chrono::milliseconds(500));
  ~ServiceLock();
  ServiceLock(const ServiceLock&) = delete;
  ServiceLock& operator=(const ServiceLock&) = delete;

 private:
  int socket_ = -1;
};

}  // namespace rtd::service
