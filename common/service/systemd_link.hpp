// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <thread>

#include "common/service/runtime.hpp"

namespace rtd::service {

/// Reports to systemd (Type=notify) that the worker runs and, as often as WatchdogSec= needs it, that it is not stuck:
/// systemd kills a service that falls silent, and starts it again. Does nothing in a process that systemd did not
/// start.
class SystemdLink {
 public:
  /// `work` is asked on a thread of the link.
  explicit SystemdLink(std::function<Heartbeat::Work()> work);
  /// Says that the service ends.
  ~SystemdLink();
  SystemdLink(const SystemdLink&) = delete;
  SystemdLink& operator=(const SystemdLink&) = delete;

 private:
  void watch(const std::stop_token& ended);

  const std::function<Heartbeat::Work()> work_;
  std::jthread thread_;
};

}  // namespace rtd::service
