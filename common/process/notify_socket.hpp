// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "common/process/process_host.hpp"

namespace rtd::process {

/// Where children say that their work continues. They do it as under systemd (Type=notify, WatchdogSec=), so that a
/// service has one way to do it (common/service/systemd_link.hpp). Belongs to one thread.
class NotifySocket {
 public:
  /// Throws ProcessError when the system has no socket left.
  NotifySocket();
  ~NotifySocket();
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  int fd() const { return fd_; }  ///< readable when a child has said something
  /// The environment of a child: that of this process, with the socket and the longest silence in it.
  std::vector<std::string> environment(std::chrono::microseconds longest_silence) const;
  /// Passes on everything that was said, e.g. "READY=1". The kernel vouches for the sender.
  void read(const std::function<void(ProcessId sender, std::string_view text)>& on_message) const;

 private:
  const int fd_;
};

}  // namespace rtd::process
