// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/rtps/common/GuidPrefix_t.hpp>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "common/bus/bus_factory.hpp"

namespace rtd::bus::fastdds {

/// Says so, through BusOptions::on_problem, when the Discovery Server is not heard within kServerPatience: without it
/// nobody is found, and Fast DDS goes on asking without a word. Thread-safe.
class ServerWatch {
 public:
  ~ServerWatch() { stop(); }
  /// Does nothing without a server in the options.
  void start(const BusOptions& options);
  void stop();
  /// A participant has appeared.
  void heard(const eprosima::fastrtps::rtps::GuidPrefix_t& participant);

 private:
  void wait_for_server(const BusOptions& options);

  std::mutex mutex_;
  std::condition_variable changed_;
  bool found_ = false, ended_ = false;
  std::thread thread_;
};

}  // namespace rtd::bus::fastdds
