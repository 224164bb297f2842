// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/source_gate.hpp"

#include <algorithm>

namespace rtd::bus {
namespace {

constexpr std::size_t kMaxClaims = 8, kMaxDeparted = 32, kMaxMatched = 256, kMaxRefused = 256;
constexpr std::int64_t kInFlightNs = 1'000'000'000;     // of one that has ended, on a busy host
constexpr std::int64_t kReceivedLatelyNs = 50'000'000;  // no need to ask whether it lives

}  // namespace

bool SourceGate::accepts(const WriterId& writer) {
  Verdict verdict;
  {
    const std::lock_guard lock(mutex_);
    verdict = judge(writer, options_.clock());
    if (!verdict.passes) ++refused_;
  }
  if (verdict.event && options_.report) options_.report(*verdict.event, verdict.source, verdict.other);
  return verdict.passes;
}

SourceGate::Verdict SourceGate::judge(const WriterId& writer, std::int64_t now_ns) {
  const ParticipantId source = participant_of(writer);
  const std::size_t place = place_of(source);
  const bool departed = std::ranges::find(departed_, writer) != departed_.end();
  if (place != kNone && place == holder_) {
    const bool ended = departed || (options_.gone && options_.gone(source));
    if (!ended) claims_[place].received_ns = now_ns;  // else it comes late: what was lost before it held it back
    claims_[place].present = claims_[place].present || !departed;
    return {true};
  }
  if (holder_ == kNone) return departed ? Verdict{true} : take(claim(source), now_ns, Event::kFirst);
  const bool gone = holder_gone(now_ns), silent = holder_silent(now_ns), vacant = gone || silent;
  if (departed) return {vacant};
  if (place != kNone && (place < holder_ || vacant)) return take(place, now_ns, Event::kBack);
  if (!vacant || (!silent && options_.successors_only && sent_beside_holder(source))) return refuse(source, now_ns);
  return take(claim(source), now_ns, gone ? Event::kTaken : Event::kSilent);
}

SourceGate::Verdict SourceGate::refuse(const ParticipantId& source, std::int64_t now_ns) {
  if (refused_since_ns_.size() >= kMaxRefused && !refused_since_ns_.contains(source)) {
    refused_since_ns_.erase(
        std::ranges::max_element(refused_since_ns_, {}, [](const auto& entry) { return entry.second; }));
  }
  refused_since_ns_.try_emplace(source, now_ns);
  return {false, Event::kRefused, claims_[holder_].source, source};
}

/// A successor of one that ended unnoticed is refused for a while, too, but receives nothing more from it.
bool SourceGate::sent_beside_holder(const ParticipantId& source) const {
  const auto refused = refused_since_ns_.find(source);
  return refused != refused_since_ns_.end() && claims_[holder_].received_ns - refused->second > kInFlightNs;
}

SourceGate::Verdict SourceGate::take(std::size_t place, std::int64_t now_ns, Event event) {
  Verdict verdict{true, event, claims_[place].source};
  if (holder_ != kNone) {
    verdict.other = claims_[holder_].source;
    ++changes_;
  }
  holder_ = place;
  refused_since_ns_.clear();
  claims_[place].received_ns = now_ns;
  claims_[place].present = true;
  return verdict;
}

bool SourceGate::holder_gone(std::int64_t now_ns) const {
  const Claim& holder = claims_[holder_];
  if (!holder.present) return true;
  return options_.gone && now_ns - holder.received_ns > kReceivedLatelyNs && options_.gone(holder.source);
}

bool SourceGate::holder_silent(std::int64_t now_ns) const {
  return now_ns - claims_[holder_].received_ns > options_.silence_ns;
}

std::size_t SourceGate::place_of(const ParticipantId& source) const {
  const auto found = std::ranges::find(claims_, source, &Claim::source);
  return found == claims_.end() ? kNone : static_cast<std::size_t>(found - claims_.begin());
}

/// A new last one. What is full forgets the last that is absent, or else the last that does not hold the place.
std::size_t SourceGate::claim(const ParticipantId& source) {
  if (claims_.size() >= kMaxClaims) {
    std::size_t leaves = kNone;
    for (std::size_t i = 0; i < claims_.size(); ++i) {
      if (i != holder_ && (leaves == kNone || claims_[leaves].present || !claims_[i].present)) leaves = i;
    }
    claims_.erase(claims_.begin() + static_cast<std::ptrdiff_t>(leaves));
    if (holder_ != kNone && leaves < holder_) --holder_;
  }
  claims_.push_back({source});
  return claims_.size() - 1;
}

void SourceGate::note(const WriterId& writer, bool matched) {
  const std::lock_guard lock(mutex_);
  std::erase(departed_, writer);
  if (!matched) {
    departed_.push_back(writer);
    if (departed_.size() > kMaxDeparted) departed_.pop_front();
  }
  const ParticipantId connection = participant_of(writer);
  if (matched) {
    if (matched_.size() < kMaxMatched || matched_.contains(connection)) ++matched_[connection];
  } else if (const auto known = matched_.find(connection); known != matched_.end() && --known->second <= 0) {
    matched_.erase(known);
  }
  const std::size_t place = place_of(connection);
  if (place != kNone) claims_[place].present = matched;
}

StatusCallbacks SourceGate::callbacks() {
  StatusCallbacks callbacks;
  const std::shared_ptr<SourceGate> gate = shared_from_this();
  callbacks.on_writer = [gate](const WriterId& writer, bool matched) { gate->note(writer, matched); };
  callbacks.accepts = [gate](const WriterId& writer) { return gate->accepts(writer); };
  return callbacks;
}

std::uint64_t SourceGate::changes() const {
  const std::lock_guard lock(mutex_);
  return changes_;
}

std::uint64_t SourceGate::refused() const {
  const std::lock_guard lock(mutex_);
  return refused_;
}

bool SourceGate::matched(const ParticipantId& connection) const {
  const std::lock_guard lock(mutex_);
  return matched_.contains(connection);
}

std::optional<ParticipantId> SourceGate::source() const {
  const std::lock_guard lock(mutex_);
  return holder_ == kNone ? std::nullopt : std::optional(claims_[holder_].source);
}

}  // namespace rtd::bus
