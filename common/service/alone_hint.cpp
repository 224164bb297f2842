// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/alone_hint.hpp"

#include <utility>

#include "common/bus/host/port_check.hpp"

namespace rtd::service {

AloneHint::AloneHint(const Heartbeat& heartbeat, const bus::BusOptions& options,
                     std::function<void(const std::string&)> say, std::chrono::milliseconds patience) {
  thread_ = std::thread([this, &heartbeat, domain = options.domain, say = std::move(say), patience] {
    if (ended_.wait_for(patience) || !heartbeat.alone()) return;
    say("no other service is in DDS domain " + std::to_string(domain) + bus::other_domains_hint(domain));
  });
}

AloneHint::~AloneHint() {
  ended_.request_stop();
  thread_.join();
}

}  // namespace rtd::service
