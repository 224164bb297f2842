// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/bus/bus_factory.hpp"

namespace rtd::bus {

/// A longer request is refused.
inline constexpr std::size_t kMaxRequestBytes = 64 * 1024;

/// Offers ROS 2 services by their bytes while it lives. Requests wait in one bounded queue (the oldest goes and gets no
/// answer) for one thread of this server, on which the handlers run.
class CallServer {
 public:
  /// Gets the request in CDR, cut off behind kMaxRequestBytes, and returns the reply. Throws nothing.
  using Handler = std::function<std::vector<std::byte>(std::span<const std::byte> request)>;
  struct Service {
    CallTopics topics;
    Handler handler;
  };

  /// Throws BusError: refused.
  CallServer(Bus& bus, std::vector<Service> services);
  /// Waits for a running handler; requests that still wait get no answer.
  ~CallServer();
  CallServer(const CallServer&) = delete;
  CallServer& operator=(const CallServer&) = delete;

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace rtd::bus
