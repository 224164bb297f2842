// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <signal.h>

namespace rtd::service {

/// SIGINT, SIGTERM and SIGHUP as a readable descriptor. Make one before any thread is started: the threads inherit the
/// blocked mask. Child processes of PosixProcessHost start with an empty mask.
class InterruptSignals {
 public:
  InterruptSignals();
  ~InterruptSignals();
  InterruptSignals(const InterruptSignals&) = delete;
  InterruptSignals& operator=(const InterruptSignals&) = delete;

  int fd() const { return fd_; }
  /// Signals that came since the last call.
  int take();

 private:
  sigset_t previous_{};
  int fd_ = -1;
};

}  // namespace rtd::service
