// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/bounded_end.hpp"

#include <cstdio>
#include <cstdlib>

namespace rtd::service {

BoundedEnd::~BoundedEnd() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void BoundedEnd::begin(int exit_code) {
  if (!thread_.joinable()) thread_ = std::thread([this, exit_code] { watch(exit_code); });
}

void BoundedEnd::watch(int exit_code) {
  std::unique_lock lock(mutex_);
  if (changed_.wait_for(lock, limit_, [this] { return ended_; })) return;
  std::fprintf(stderr, "%s: the bus did not end within %lld ms and is left behind\n", program_.c_str(),
               static_cast<long long>(limit_.count()));
  std::fflush(nullptr);
  std::_Exit(exit_code);
}

}  // namespace rtd::service
