// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/io/printable.hpp"
#include "common/msg/largest_sample.hpp"
#include "common/service/log.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"
#include "common/service/runtime.hpp"

namespace rtd::service {
namespace {

constexpr std::chrono::milliseconds kPeriod{200}, kLookPeriod{100};
constexpr std::int64_t kGoneAfterNs = 700'000'000;       // three heartbeats missed, with a margin for a busy host
constexpr std::int64_t kBlockedAfterNs = 3'000'000'000;  // a write may wait for a slow reader, but not so long

void add_troubles(const std::string& topic, const bus::TopicTrouble& trouble, std::vector<msg::Metric>& metrics) {
  const auto add = [&](const char* what, std::uint64_t count) {
    if (count > 0) metrics.push_back({metric::kTopicPrefix + topic + '.' + what, static_cast<double>(count)});
  };
  add("lost", trouble.lost);
  add("rejected", trouble.rejected);
  add("incompatible_qos", trouble.incompatible_qos);
  add("type_mismatch", trouble.type_mismatch);
  add("implausible", trouble.implausible);
  add("too_large", trouble.too_large);
}

void log_refusals(const std::string& topic, const bus::TopicTrouble& before, const bus::TopicTrouble& now) {
  if (now.incompatible_qos > before.incompatible_qos) {
    SPDLOG_ERROR("event=incompatible_qos topic={} policy={} fix=\"use the QoS of docs/topics.md\"", topic, now.policy);
  }
  if (now.type_mismatch > before.type_mismatch) {
    SPDLOG_ERROR("event=type_mismatch topic={} other_type={} fix=\"another program uses this topic's name\"", topic,
                 now.other_type);
  }
  if (before.implausible == 0 && now.implausible > 0) {
    SPDLOG_ERROR(
        "event=implausible_message topic={} field={} fix=\"a program sends what none of RTD-SLAM does: find it with "
        "'rtd topics list', stop it, or keep it out with keys (docs/security.md)\"",
        topic, now.implausible_field);
  }
  if (before.too_large == 0 && now.too_large > 0)
    SPDLOG_ERROR("event=message_too_large topic={} effect=\"it was not sent\" limit=\"docs/topics.md\"", topic);
}

/// The metrics that a heartbeat has room for: names of topics are those of others.
void fit(std::vector<msg::Metric>& metrics) {
  constexpr std::size_t kForTheRest = 8192, kBesideName = 24;
  std::size_t bytes = kForTheRest;
  const auto has_no_room = [&bytes](const msg::Metric& metric) {
    bytes += metric.name.size() + kBesideName;
    return bytes > msg::largest_sample<msg::ServiceStatus>();
  };
  metrics.erase(std::ranges::find_if(metrics, has_no_room), metrics.end());
}

void make_plausible(msg::ServiceStatus& status) {
  constexpr std::size_t kMaxMessage = 4096, kMaxName = 384;
  if (!io::is_printable(status.message)) status.message = io::printable(status.message);
  if (status.message.size() > kMaxMessage) status.message = io::printable(status.message.substr(0, kMaxMessage / 4));
  for (auto& [name, value] : status.metrics) {
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c <= ' ' || c > '~'; }, '?');
    if (name.size() > kMaxName) name.resize(kMaxName);
    if (!std::isfinite(value)) value = 0;
  }
  fit(status.metrics);
}

}  // namespace

std::string host_name() {
  std::array<char, 256> name{};
  const bool known = gethostname(name.data(), name.size() - 1) == 0 && name[0] != '\0';
  return known ? name.data() : "localhost";
}

Heartbeat::Heartbeat(bus::Bus& bus, std::string service_name, StopToken& stop, SecondInstance second_instance)
    : bus_(bus),
      stop_(stop),
      second_instance_(second_instance),
      own_name_(service_name),
      started_ns_(realtime_ns()),
      looked_ns_(monotonic_ns()),
      clocks_(service_name, PeerClocks::this_host_id()),
      peers_(process_gone()),
      inputs_(bus::topic_of_robot(bus::topics::kStatus.name, bus.robot())) {
  own_.service = std::move(service_name);
  own_.metrics.push_back({metric::kHostId, PeerClocks::this_host_id()});
  own_.metrics.push_back({metric::kHostNamePrefix + host_name(), 1});
  own_.pid = getpid();
  own_.started_ns = started_ns_;
  writer_ = bus.writer(bus::topics::kStatus);
  reader_ = bus.reader<msg::ServiceStatus>(bus::topics::kStatus,
                                           [this](const std::shared_ptr<const msg::ServiceStatus>& status,
                                                  const bus::WriterId& writer) { receive(*status, writer); });
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
    const std::int64_t now_ns = monotonic_ns();
    looked_ns_ = now_ns;
    exclude_standstill(now_ns);
    forget_silent(now_ns);
    bool changed = check_peers();
    changed = check_inputs() || changed;
    changed = check_progress() || changed;
    changed = check_topics() || changed;
    if (changed || turn % (kPeriod / kLookPeriod) == 0) publish();
  }
}

/// No service was silent, and no worker stuck, while this whole process stood still.
void Heartbeat::exclude_standstill(std::int64_t now_ns) {
  const std::int64_t stood_still_ns = standstill_.look(now_ns);
  if (stood_still_ns == 0) return;
  SPDLOG_WARN("event=stood_still for_ms={} cause=\"stopped, paused, or no processor time\"",
              stood_still_ns / 1'000'000);
  const std::lock_guard lock(mutex_);
  progress_.exclude_pause(stood_still_ns);
  peers_.exclude_pause(stood_still_ns, now_ns);
}

void Heartbeat::forget_silent(std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  for (const std::string& name : peers_.forget_silent(now_ns)) {
    clocks_.forget(name);
    const std::string prefix = metric::kClockPrefix + name + '.';
    std::erase_if(own_.metrics, [&](const msg::Metric& metric) { return metric.name.starts_with(prefix); });
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

void Heartbeat::set_word(const std::string& prefix, const std::string& word) {
  const std::lock_guard lock(mutex_);
  std::erase_if(own_.metrics, [&](const msg::Metric& own) {
    return own.name.starts_with(prefix) && own.name.compare(prefix.size(), std::string::npos, word) != 0;
  });
  set({prefix + word, 1});
}

/// Under the lock.
void Heartbeat::set(const msg::Metric& metric) {
  const auto found = std::ranges::find(own_.metrics, metric.name, &msg::Metric::name);
  if (found == own_.metrics.end())
    own_.metrics.push_back(metric);
  else
    found->value = metric.value;
}

void Heartbeat::receive(const msg::ServiceStatus& status, const bus::WriterId& writer) {
  if (writer == writer_.id()) return;
  if (status.service == own_name_) return report_second_instance(status, writer);
  processes_.note(status, writer);
  if (!note(status, writer)) return;
  const std::lock_guard callback_lock(callback_mutex_);
  if (callback_) callback_(status);
}

/// False when another connection has that name.
bool Heartbeat::note(const msg::ServiceStatus& status, const bus::WriterId& writer) {
  const std::int64_t arrival_ns = realtime_ns();
  const std::lock_guard lock(mutex_);
  if (!peers_.note(status, writer, monotonic_ns())) {
    set({metric::kHeartbeatsRefused, static_cast<double>(peers_.refused())});
    return false;
  }
  for (const msg::Metric& metric : clocks_.received(status, arrival_ns)) set(metric);
  return true;
}

void Heartbeat::accept_only_from(const std::string& service, std::weak_ptr<const bus::SourceGate> writers) {
  const std::lock_guard lock(mutex_);
  peers_.accept_only_from(service, std::move(writers));
}

void Heartbeat::report_second_instance(const msg::ServiceStatus& second, const bus::WriterId& writer) {
  if (second_instance_ == SecondInstance::kAllowed || !second_instance_log_.pass()) return;
  SPDLOG_ERROR(
      "event=second_service service={} pid={} source={} effect=\"this one continues; the others follow the one whose "
      "messages came first\" fix=\"stop one, or give it another --domain\"",
      second.service, second.pid, bus::to_string(writer));
}

/// Under the lock.
const Peer* Heartbeat::find(const std::string& service) const {
  const auto found = peers_.peers().find(service);
  return found == peers_.peers().end() ? nullptr : &found->second;
}

bool Heartbeat::alive(const std::string& service) const {
  const std::lock_guard lock(mutex_);
  const Peer* const peer = find(service);
  return peer != nullptr && peer->status.state != msg::ServiceState::kFinished && peer->health == PeerHealth::kAlive &&
         monotonic_ns() - peer->received_ns < kGoneAfterNs;
}

bool Heartbeat::gone(const std::string& service) const {
  const std::lock_guard lock(mutex_);
  const Peer* const peer = find(service);
  return peer == nullptr || peer->status.state == msg::ServiceState::kFinished || surely_gone(peer->evidence);
}

bool Heartbeat::alone() const {
  const std::lock_guard lock(mutex_);
  return peers_.peers().empty();
}

std::optional<double> Heartbeat::metric_on_this_host(const std::string& service, const std::string& metric) const {
  if (!alive(service)) return std::nullopt;
  const std::lock_guard lock(mutex_);
  const Peer* const peer = find(service);
  if (peer == nullptr || find_metric(peer->status, metric::kHostId) != find_metric(own_, metric::kHostId))
    return std::nullopt;
  return find_metric(peer->status, metric);
}

std::string Heartbeat::word_of(const std::string& service, const std::string& prefix) const {
  const std::lock_guard lock(mutex_);
  const Peer* const peer = find(service);
  return peer == nullptr ? std::string() : msg::word_of(peer->status, prefix);
}

bool Heartbeat::ready(const std::string& service) const {
  if (!alive(service)) return false;
  const std::lock_guard lock(mutex_);
  const Peer* const peer = find(service);
  return peer != nullptr && msg::is_ready(peer->status.state);
}

void Heartbeat::on_status(std::function<void(const msg::ServiceStatus&)> callback) {
  const std::lock_guard lock(callback_mutex_);
  callback_ = std::move(callback);
}

void Heartbeat::tick() {
  const std::lock_guard lock(mutex_);
  progress_.tick(monotonic_ns());
  begun_ = true;
}

void Heartbeat::idle() {
  const std::lock_guard lock(mutex_);
  progress_.idle();
}

void Heartbeat::watch_progress(std::chrono::milliseconds limit) {
  const std::lock_guard lock(mutex_);
  progress_.set_limit(std::chrono::nanoseconds(limit).count());
}

Heartbeat::Work Heartbeat::work() const {
  const std::lock_guard lock(mutex_);
  if (!begun_) return Work::kNotBegun;
  const bool blocked = monotonic_ns() - looked_ns_ > kBlockedAfterNs;
  return !stuck_.empty() || blocked ? Work::kStuck : Work::kContinues;
}

/// True when the health of one has changed.
bool Heartbeat::check_peers() {
  const std::lock_guard lock(mutex_);
  const std::int64_t now_ns = monotonic_ns();
  const double own_host = find_metric(own_, metric::kHostId).value_or(0);
  bool changed = false;
  for (auto& [name, peer] : peers_.peers()) {
    PeerEvidence evidence{now_ns - peer.received_ns, ProcessState::kUnknown};
    const bool here = find_metric(peer.status, metric::kHostId).value_or(0) == own_host;
    if (evidence.silent_ns >= kSuspectAfterNs && here) evidence.process = process_state(peer.status.pid);
    peer.evidence = evidence;
    const bool ended = peer.status.state == msg::ServiceState::kFinished;
    const PeerHealth health = ended ? PeerHealth::kAlive : judge(evidence);
    if (health == peer.health) continue;
    const bool trouble = health == PeerHealth::kDead || health == PeerHealth::kHung;
    SPDLOG_LOGGER_CALL(spdlog::default_logger_raw(), trouble ? spdlog::level::warn : spdlog::level::info,
                       "event=peer_{} service={} pid={} silent_ms={}", to_string(health), name, peer.status.pid,
                       evidence.silent_ns / 1'000'000);
    peer.health = health;
    changed = true;
  }
  return changed;
}

/// True when an input fell silent, or is not any more.
bool Heartbeat::check_inputs() {
  const auto& traffic = bus_.traffic();
  Sender own{own_name_, bus::participant_of(writer_.id()), true, traffic.sent()};
  const std::lock_guard lock(mutex_);
  const auto inputs = stop_.stop_requested() ? SilentInputs::Inputs() : traffic.inputs();
  return inputs_.look(inputs, std::move(own), peers_, monotonic_ns());
}

/// True when the worker got stuck or free.
bool Heartbeat::check_progress() {
  const std::lock_guard lock(mutex_);
  const std::int64_t stuck_ns = progress_.stuck_ns(monotonic_ns());
  std::string cause = inputs_.lost();
  if (stuck_ns > 0) cause = "its worker makes no progress";
  if (stop_.stop_requested()) cause.clear();
  if (cause.empty() == stuck_.empty()) return false;
  stuck_ = std::move(cause);
  if (stuck_.empty()) {
    SPDLOG_INFO("event=worker_continues");
  } else {
    SPDLOG_WARN("event=worker_stuck for_ms={} cause=\"{}\"", stuck_ns / 1'000'000, stuck_);
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
    changed = changed || now.incompatible_qos != before.incompatible_qos || now.type_mismatch != before.type_mismatch ||
              (before.implausible == 0 && now.implausible > 0);
  }
  troubles_ = std::move(troubles);
  return changed;
}

/// State and metrics of the service, and what is wrong with it, its peers and its topics. Texts of exceptions and names
/// of topics of others may hold anything; no receiver takes such a heartbeat (common/msg/plausible.hpp).
msg::ServiceStatus Heartbeat::current_status() {
  const std::lock_guard lock(mutex_);
  own_.stamp_ns = realtime_ns();
  msg::ServiceStatus status = own_;
  for (const auto& [name, peer] : peers_.peers()) {
    if (peer.health != PeerHealth::kAlive) {
      status.metrics.push_back({fmt::format("{}{}.{}", metric::kPeerPrefix, name, to_string(peer.health)), 1});
    }
  }
  for (const auto& [topic, trouble] : troubles_) add_troubles(topic, trouble, status.metrics);
  for (const auto& [topic, sent] : bus_.traffic().sent()) {
    if (bus::concerns_robot(topic, bus_.robot()))
      status.metrics.push_back({metric::kSentPrefix + topic, static_cast<double>(sent)});
  }
  inputs_.add_to(status);
  if (!stuck_.empty()) {
    status.state = msg::ServiceState::kDegraded;
    status.message = "hung: " + stuck_;
    status.metrics.push_back({metric::kHung, 1});
  }
  make_plausible(status);
  return status;
}

/// Separates an orderly end from a death.
void Heartbeat::publish_end() {
  {
    const std::lock_guard lock(mutex_);
    if (own_.state == msg::ServiceState::kFailed) return;
    own_.state = msg::ServiceState::kFinished;
    stuck_.clear();
  }
  publish();
  constexpr int kLongEnoughMs = 100;
  writer_.wait_acknowledged(kLongEnoughMs);
}

}  // namespace rtd::service
