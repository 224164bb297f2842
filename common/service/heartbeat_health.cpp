// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// The part of the heartbeat that watches the health of peers, of the own worker and of the topics.
#include <fmt/format.h>

#include "common/service/log.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/realtime_clock.hpp"
#include "common/service/runtime.hpp"

namespace rtd::service {
namespace {

void add_troubles(const std::string& topic, const bus::TopicTrouble& trouble, std::vector<msg::Metric>& metrics) {
  const auto add = [&](const char* what, std::uint64_t count) {
    if (count > 0) metrics.push_back({"topic." + topic + '.' + what, static_cast<double>(count)});
  };
  add("lost", trouble.lost);
  add("rejected", trouble.rejected);
  add("incompatible_qos", trouble.incompatible_qos);
  add("type_mismatch", trouble.type_mismatch);
}

void log_refusals(const std::string& topic, const bus::TopicTrouble& before, const bus::TopicTrouble& now) {
  if (now.incompatible_qos > before.incompatible_qos) {
    SPDLOG_ERROR("event=incompatible_qos topic={} policy={} fix=\"use the QoS of docs/topics.md\"", topic, now.policy);
  }
  if (now.type_mismatch > before.type_mismatch) {
    SPDLOG_ERROR("event=type_mismatch topic={} other_type={} fix=\"another program uses this topic's name\"", topic,
                 now.other_type);
  }
}

}  // namespace

void Heartbeat::tick() {
  const std::lock_guard lock(mutex_);
  progress_.tick(monotonic_ns());
}

void Heartbeat::idle() {
  const std::lock_guard lock(mutex_);
  progress_.idle();
}

void Heartbeat::watch_progress(std::chrono::milliseconds limit) {
  const std::lock_guard lock(mutex_);
  progress_.set_limit(std::chrono::nanoseconds(limit).count());
}

/// True when the health of one has changed.
bool Heartbeat::check_peers() {
  const std::lock_guard lock(mutex_);
  const std::int64_t now_ns = monotonic_ns();
  const double own_host = find_metric(own_, "host_id").value_or(0);
  bool changed = false;
  for (auto& [name, peer] : peers_) {
    PeerEvidence evidence{now_ns - peer.received_ns, ProcessState::kUnknown};
    const bool here = find_metric(peer.status, "host_id").value_or(0) == own_host;
    if (evidence.silent_ns >= kSuspectAfterNs && here) evidence.process = process_state(peer.status.pid);
    const bool ended = peer.status.state == msg::ServiceState::kFinished;
    const PeerHealth health = ended ? PeerHealth::kAlive : judge(evidence);
    if (health == peer.health) continue;
    SPDLOG_WARN("event=peer_{} service={} pid={} silent_ms={}", to_string(health), name, peer.status.pid,
                evidence.silent_ns / 1'000'000);
    peer.health = health;
    changed = true;
  }
  return changed;
}

/// True when the worker got stuck or free.
bool Heartbeat::check_progress() {
  const std::lock_guard lock(mutex_);
  const std::int64_t stuck_ns = stop_.stop_requested() ? 0 : progress_.stuck_ns(monotonic_ns());
  if ((stuck_ns > 0) == stuck_) return false;
  stuck_ = stuck_ns > 0;
  if (stuck_) {
    SPDLOG_ERROR("event=worker_stuck for_ms={}", stuck_ns / 1'000'000);
  } else {
    SPDLOG_INFO("event=worker_goes_on");
  }
  return true;
}

/// True when peers were refused: losses may count up with every frame.
bool Heartbeat::check_topics() {
  auto troubles = bus_.troubles();
  const std::lock_guard lock(mutex_);
  bool changed = false;
  for (const auto& [topic, now] : troubles) {
    const bus::TopicTrouble before = troubles_[topic];
    log_refusals(topic, before, now);
    changed = changed || now.incompatible_qos != before.incompatible_qos || now.type_mismatch != before.type_mismatch;
  }
  troubles_ = std::move(troubles);
  return changed;
}

/// State and metrics of the service, and what is wrong with it, its peers and its topics.
msg::ServiceStatus Heartbeat::current_status() {
  const std::lock_guard lock(mutex_);
  own_.stamp_ns = realtime_ns();
  msg::ServiceStatus status = own_;
  for (const auto& [name, peer] : peers_) {
    if (peer.health != PeerHealth::kAlive) {
      status.metrics.push_back({fmt::format("peer.{}.{}", name, to_string(peer.health)), 1});
    }
  }
  for (const auto& [topic, trouble] : troubles_) add_troubles(topic, trouble, status.metrics);
  if (stuck_) {
    status.state = msg::ServiceState::kDegraded;
    status.message = "hung: its worker makes no progress";
    status.metrics.push_back({"hung", 1});
  }
  return status;
}

/// Tells an orderly end from a death.
void Heartbeat::publish_end() {
  {
    const std::lock_guard lock(mutex_);
    if (own_.state == msg::ServiceState::kFailed || !duplicate_.empty()) return;
    own_.state = msg::ServiceState::kFinished;
    stuck_ = false;
  }
  publish();
  constexpr int kLongEnoughMs = 100;
  writer_.wait_acknowledged(kLongEnoughMs);
}

}  // namespace rtd::service
