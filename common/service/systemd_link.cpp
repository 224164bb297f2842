// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/systemd_link.hpp"

#include <systemd/sd-daemon.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <utility>

namespace rtd::service {
namespace {

using std::chrono::microseconds;
constexpr microseconds kNotifyPeriod{50'000};

}  // namespace

SystemdLink::SystemdLink(std::function<Heartbeat::Work()> work) : work_(std::move(work)) {
  if (std::getenv("NOTIFY_SOCKET") == nullptr) return;
  thread_ = std::jthread([this](const std::stop_token& ended) { watch(ended); });
}

SystemdLink::~SystemdLink() {
  if (!thread_.joinable()) return;
  sd_notify(0, "STOPPING=1");
}

/// The watchdog gets three signs of life in its time.
void SystemdLink::watch(const std::stop_token& ended) {
  std::uint64_t limit_us = 0;
  const bool watched = sd_watchdog_enabled(0, &limit_us) > 0;
  microseconds period = watched ? std::min(kNotifyPeriod, microseconds(limit_us / 3)) : kNotifyPeriod;
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  bool ready = false;
  while (!ended.stop_requested()) {
    const Heartbeat::Work work = work_();
    if (!ready && work != Heartbeat::Work::kNotBegun) {
      sd_notify(0, "READY=1");
      ready = true;
      if (!watched) return;
      period = microseconds(limit_us / 3);
    }
    if (watched && work != Heartbeat::Work::kStuck) sd_notify(0, "WATCHDOG=1");
    wake.wait_for(lock, ended, period, [] { return false; });
  }
}

}  // namespace rtd::service
