// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "common/service/monotonic_clock.hpp"
#include "common/service/realtime_clock.hpp"
#include "common/service/runtime.hpp"

namespace rtd::service {
namespace {

constexpr std::chrono::milliseconds kPeriod{200}, kLookPeriod{100};
constexpr std::int64_t kGoneAfterNs = 700'000'000;      // three heartbeats missed, with a margin for a busy host
constexpr std::int64_t kNewcomerForNs = 5'000'000'000;  // a service that has run for longer never ends for a duplicate
constexpr std::size_t kMostPeers = 100;                 // a writer could make up names without end

bool is_name(const std::string& service) {
  constexpr std::size_t kLongest = 64;
  return !service.empty() && service.size() <= kLongest &&
         std::all_of(service.begin(), service.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '/' || c == '.';
         });
}

}  // namespace

Heartbeat::Heartbeat(bus::Bus& bus, std::string service_name, StopToken& stop)
    : bus_(bus), stop_(stop), clocks_(service_name, PeerClocks::this_host_id()) {
  own_.service = std::move(service_name);
  own_.metrics.push_back({"host_id", PeerClocks::this_host_id()});
  own_.pid = getpid();
  own_.started_ns = realtime_ns();
  writer_ = bus.writer(bus::topics::kStatus);
  reader_ = bus.reader<msg::ServiceStatus>(
      bus::topics::kStatus, [this](const std::shared_ptr<const msg::ServiceStatus>& status) { receive(*status); });
  thread_ = std::thread([this] { loop(); });
}

Heartbeat::~Heartbeat() {
  ended_.request_stop();
  thread_.join();
  publish_end();
}

/// Checks the others twice as often as it publishes; changes are published at once.
void Heartbeat::loop() {
  for (int turn = 0; !ended_.wait_for(kLookPeriod); ++turn) {
    bool changed = check_peers();
    changed = check_progress() || changed;
    changed = check_topics() || changed;
    if (changed || turn % (kPeriod / kLookPeriod) == 0) publish();
  }
}

void Heartbeat::publish() {
  const std::lock_guard publish_lock(publish_mutex_);
  writer_.write(current_status());
}

void Heartbeat::set_state(msg::ServiceState state, const std::string& message) {
  {
    const std::lock_guard lock(mutex_);
    if (own_.state == state && own_.message == message) return;
    own_.state = state;
    own_.message = message;
  }
  publish();
}

void Heartbeat::set_metric(const std::string& name, double value) {
  const std::lock_guard lock(mutex_);
  set({name, value});
}

/// Under the lock.
void Heartbeat::set(const msg::Metric& metric) {
  const auto found = std::find_if(own_.metrics.begin(), own_.metrics.end(),
                                  [&](const msg::Metric& own) { return own.name == metric.name; });
  if (found == own_.metrics.end()) {
    own_.metrics.push_back(metric);
  } else {
    found->value = metric.value;
  }
}

void Heartbeat::receive(const msg::ServiceStatus& status) {
  if (!is_name(status.service)) return;
  const std::int64_t arrival_ns = realtime_ns();
  bool refused = false, known = false;
  {
    const std::lock_guard lock(mutex_);
    if (status.service == own_.service) {
      const bool self = status.pid == own_.pid && status.started_ns == own_.started_ns;
      // Heartbeats are volatile: their sender is alive. The older instance stays, the younger one ends.
      // One heartbeat is not enough: any program may have sent it.
      const bool newcomer = arrival_ns - own_.started_ns < kNewcomerForNs;
      const bool older =
          newcomer && !self && status.state != msg::ServiceState::kFinished && status.started_ns < own_.started_ns;
      const bool again = older && twin_ == std::pair(status.pid, status.started_ns);
      if (older) twin_ = {status.pid, status.started_ns};
      if (again) {
        duplicate_ = fmt::format(
            "another {} (pid {}) already runs in this DDS domain: stop it first or choose another domain with --domain",
            status.service, status.pid);
        refused = true;
      }
    } else if (peers_.size() < kMostPeers || peers_.contains(status.service)) {
      Peer& peer = peers_[status.service];
      peer.status = status;
      peer.received_ns = monotonic_ns();
      for (const msg::Metric& metric : clocks_.received(status, arrival_ns)) set(metric);
      known = true;
    }
  }
  if (refused) stop_.request_stop();
  if (!known) return;
  const std::lock_guard callback_lock(callback_mutex_);
  if (callback_) callback_(status);
}

bool Heartbeat::alive(const std::string& service) const {
  const std::lock_guard lock(mutex_);
  const auto found = peers_.find(service);
  return found != peers_.end() && found->second.status.state != msg::ServiceState::kFinished &&
         found->second.health == PeerHealth::kAlive && monotonic_ns() - found->second.received_ns < kGoneAfterNs;
}

bool Heartbeat::alone() const {
  const std::lock_guard lock(mutex_);
  return peers_.empty();
}

bool Heartbeat::ready(const std::string& service) const {
  if (!alive(service)) return false;
  const std::lock_guard lock(mutex_);
  const msg::ServiceState state = peers_.at(service).status.state;
  return state == msg::ServiceState::kReady || state == msg::ServiceState::kRunning ||
         state == msg::ServiceState::kDegraded;
}

void Heartbeat::on_status(std::function<void(const msg::ServiceStatus&)> callback) {
  const std::lock_guard lock(callback_mutex_);
  callback_ = std::move(callback);
}

std::string Heartbeat::duplicate() const {
  const std::lock_guard lock(mutex_);
  return duplicate_;
}

}  // namespace rtd::service
