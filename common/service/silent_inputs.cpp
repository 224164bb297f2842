// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/silent_inputs.hpp"

#include <algorithm>
#include <optional>

#include "common/service/log.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/peer_clocks.hpp"

namespace rtd::service {
namespace {

/// Who sends for `sender` on this topic: its own connection, or else the source that was followed last, when no service
/// speaks for that one: a replay sends its heartbeats on another connection, and a successor may not be found yet.
bus::ParticipantId connection_of(const Sender& sender, const bus::Input& input, const std::vector<Sender>& senders) {
  const std::optional<bus::ParticipantId> source = input.source();
  if (!source || input.received(sender.connection)) return sender.connection;
  const bool speaks = std::ranges::count(senders, *source, &Sender::connection) > 0;
  return speaks ? sender.connection : *source;
}

/// Whatever a metric claims.
std::uint64_t counted(double value) {
  constexpr double kMaxCounted = 9e15;  // beyond, a double counts no single messages
  return value > 0 ? static_cast<std::uint64_t>(std::min(value, kMaxCounted)) : 0;
}

bool is_here(const Peer& peer) {
  return find_metric(peer.status, metric::kHostId) == PeerClocks::this_host_id();
}

/// `own` and the others whose heartbeats still come.
std::vector<Sender> living_senders(Sender own, const PeerTable& peers, std::int64_t now_ns) {
  std::vector<Sender> senders{std::move(own)};
  for (const auto& [name, peer] : peers.peers()) {
    if (now_ns - peer.received_ns > kSilentAfterNs || peer.status.state == msg::ServiceState::kFinished) continue;
    Sender& sender = senders.emplace_back(Sender{name, bus::participant_of(peer.writer), is_here(peer), {}});
    for (const auto& [about, value] : peer.status.metrics) {
      if (about.starts_with(metric::kSentPrefix))
        sender.sent[about.substr(std::size(metric::kSentPrefix) - 1)] = counted(value);
    }
  }
  return senders;
}

/// Whether another service of this host, one that knew it, still receives the heartbeats of one whose process is there.
bool reaches_another(const std::string& name, const Peer& peer, const PeerTable& peers, std::int64_t now_ns) {
  constexpr std::int64_t kOthersNoticedNs = 1'800'000'000;
  if (peer.health != PeerHealth::kHung || now_ns - peer.received_ns < kOthersNoticedNs) return false;
  const std::string report = metric::kPeerPrefix + name + '.';
  return std::ranges::any_of(peers.peers(), [&](const auto& entry) {
    const Peer& other = entry.second;
    const bool knew_it = is_here(other) && other.status.started_ns < peer.status.stamp_ns;
    return knew_it && now_ns - other.received_ns < kSuspectAfterNs &&
           std::ranges::none_of(other.status.metrics,
                                [&](const auto& metric) { return metric.name.starts_with(report); });
  });
}

}  // namespace

bool InputWatch::silent(std::uint64_t received, std::uint64_t sent) {
  constexpr int kCountedLate = 5, kOnTheirWay = 12;  // looks
  constexpr std::uint64_t kEnough = 2;
  if (received != received_ || sent < sent_) since_received_ = 0;
  received_ = received;
  if (since_received_++ <= kCountedLate) sent_ = sent;
  since_complete_ = sent == sent_ ? 0 : since_complete_ + 1;
  return sent - sent_ >= kEnough && since_complete_ >= kOnTheirWay;
}

std::set<SilentInputs::Silent> SilentInputs::silent_now(const Inputs& inputs, const std::vector<Sender>& senders) {
  decltype(watches_) watches;
  std::set<Silent> silent;
  for (const auto& input : inputs) {
    for (const Sender& sender : senders) {
      const auto sent = sender.sent.find(input->topic());
      if (sent == sender.sent.end()) continue;
      const bus::ParticipantId connection = connection_of(sender, *input, senders);
      const std::optional<std::uint64_t> received = input->received(connection);
      if (!received) continue;
      const std::pair key(input.get(), connection);
      InputWatch& watch = watches[key] = watches_[key];
      if (!watch.silent(*received, sent->second)) continue;
      const bool speaks_for_it = connection == sender.connection || sender.name == "replay";
      const bool follows = input->gated() && input->source() == connection && speaks_for_it;
      silent.insert({input->topic(), sender.name, sender.here && (follows || input->topic() == heartbeats_)});
    }
  }
  watches_ = std::move(watches);
  return silent;
}

bool SilentInputs::look(const Inputs& inputs, Sender own, const PeerTable& peers, std::int64_t now_ns) {
  std::set<Silent> silent = silent_now(inputs, living_senders(std::move(own), peers, now_ns));
  for (const auto& [name, peer] : peers.peers()) {
    if (!inputs.empty() && reaches_another(name, peer, peers, now_ns)) silent.insert({heartbeats_, name, false});
  }
  for (const Silent& one : silent) {
    if (!silent_.contains(one)) SPDLOG_WARN("event=input_silent topic={} from={}", one.topic, one.sender);
  }
  for (const Silent& one : silent_) {
    if (!silent.contains(one)) SPDLOG_INFO("event=input_back topic={} from={}", one.topic, one.sender);
  }
  return std::exchange(silent_, silent) != silent;
}

std::string SilentInputs::lost() const {
  const auto found = std::ranges::find(silent_, true, &Silent::lost);
  return found == silent_.end() ? "" : found->text();
}

void SilentInputs::add_to(msg::ServiceStatus& status) const {
  for (const Silent& one : silent_) {
    status.metrics.push_back({metric::kTopicPrefix + one.topic + ".silent", 1});
    if (status.state >= msg::ServiceState::kDegraded) continue;
    status.state = msg::ServiceState::kDegraded;
    status.message = one.text();
  }
}

}  // namespace rtd::service
