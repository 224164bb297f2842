// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include "common/service/runtime.hpp"

namespace rtd::service {

/// Says once, when no other service has been heard for a while, where this one listens, and where else on this host
/// others may be. To wait alone is no error: the others may be yet to come.
class AloneHint {
 public:
  static constexpr std::chrono::milliseconds kUsualPatience{10'000};

  /// `say` is called by a thread of its own.
  AloneHint(const Heartbeat& heartbeat, const bus::BusOptions& options, std::function<void(const std::string&)> say,
            std::chrono::milliseconds patience = kUsualPatience);
  ~AloneHint();
  AloneHint(const AloneHint&) = delete;
  AloneHint& operator=(const AloneHint&) = delete;

 private:
  StopToken ended_;
  std::thread thread_;
};

}  // namespace rtd::service
