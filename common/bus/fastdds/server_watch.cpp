// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/server_watch.hpp"

#include "common/bus/fastdds/network_mapping.hpp"
#include "common/bus/network.hpp"

namespace rtd::bus::fastdds {

void ServerWatch::start(const BusOptions& options) {
  if (options.network.discovery_server.empty() || !options.on_problem) return;
  thread_ = std::thread([this, options] { wait_for_server(options); });
}

void ServerWatch::stop() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void ServerWatch::heard(const eprosima::fastrtps::rtps::GuidPrefix_t& participant) {
  if (participant != server_prefix()) return;
  {
    const std::lock_guard lock(mutex_);
    found_ = true;
  }
  changed_.notify_all();
}

void ServerWatch::wait_for_server(const BusOptions& options) {
  std::unique_lock lock(mutex_);
  if (changed_.wait_for(lock, kServerPatience, [this] { return found_ || ended_; })) return;
  lock.unlock();
  options.on_problem(no_server_problem(options));
}

}  // namespace rtd::bus::fastdds
