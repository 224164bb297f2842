// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/fleet/fleet_arrivals.hpp"

#include <chrono>
#include <utility>

#include "common/service/monotonic_clock.hpp"

namespace rtd::detector {

void FleetArrivals::put(const std::string& robot, std::shared_ptr<const msg::CompressedImage> jpeg) {
  {
    const std::lock_guard lock(mutex_);
    queue_.put(robot, std::move(jpeg), service::monotonic_ns());
  }
  changed_.notify_one();
}

std::vector<FleetArrivals::Queue::Taken> FleetArrivals::take() {
  std::unique_lock lock(mutex_);
  while (!closed_) {
    Queue::Turn turn = queue_.take(service::monotonic_ns());
    if (!turn.batch.empty()) return std::move(turn.batch);
    if (turn.wait_until_ns) {
      changed_.wait_until(lock, std::chrono::steady_clock::time_point(std::chrono::nanoseconds(*turn.wait_until_ns)));
    } else {
      changed_.wait(lock);
    }
  }
  return {};
}

void FleetArrivals::remove(const std::string& robot) {
  const std::lock_guard lock(mutex_);
  queue_.remove(robot);
}

std::uint64_t FleetArrivals::dropped(const std::string& robot) const {
  const std::lock_guard lock(mutex_);
  return queue_.dropped(robot);
}

void FleetArrivals::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

}  // namespace rtd::detector
