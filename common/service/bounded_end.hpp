// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace rtd::service {

/// Ends the process when what was declared behind this takes too long to be destroyed: a bus that strangers have spoilt
/// must not keep a program from ending whose work is done.
class BoundedEnd {
 public:
  BoundedEnd(std::string program, std::chrono::milliseconds limit) : program_(std::move(program)), limit_(limit) {}
  ~BoundedEnd();
  BoundedEnd(const BoundedEnd&) = delete;
  BoundedEnd& operator=(const BoundedEnd&) = delete;

  /// The work is done, all results are written: from now on the time counts.
  void begin(int exit_code);

 private:
  void watch(int exit_code);

  const std::string program_;
  const std::chrono::milliseconds limit_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace rtd::service
