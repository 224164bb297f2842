// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/fleet/duty.hpp"

#include <algorithm>

namespace rtd::detector {

void Duty::observe(const Claim& other, const std::string& name, bool serves, std::int64_t now_ns) {
  if (!serves) {
    others_.erase(other);
    return;
  }
  if (others_.size() >= kMaxOthers && !others_.contains(other)) return;
  Other& known = others_[other];
  known.name = name;
  known.received_ns = now_ns;
  ++known.times;
}

/// While nothing is at stake one heartbeat is enough to wait.
bool Duty::must_yield(const Claim& own) const {
  if (role_ != Role::kServing) return !others_.empty();
  return std::ranges::any_of(
      others_, [&](const auto& other) { return other.first < own && other.second.times >= kBelievedAfter; });
}

Duty::Role Duty::update(const Claim& own, std::int64_t now_ns) {
  std::erase_if(others_, [now_ns](const auto& other) { return now_ns - other.second.received_ns >= kSilentNs; });
  if (must_yield(own)) {
    role_ = Role::kStandby;
  } else if (role_ == Role::kStandby || now_ns - began_ns_ >= kListenNs) {
    role_ = Role::kServing;
  }
  other_ = role_ == Role::kStandby ? others_.begin()->second.name : std::string();
  return role_;
}

}  // namespace rtd::detector
