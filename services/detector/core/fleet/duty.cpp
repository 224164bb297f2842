// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/fleet/duty.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rtd::detector {
namespace {

constexpr double kNsPerMs = 1e6, kNsPerS = 1e9;
constexpr double kLeastWindowS = 1;  // the first answers alone make no rate

/// The value below which the share lies; `values` is not empty and is reordered.
double quantile(std::vector<double>& values, double share) {
  const auto rank = std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace

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

void AnswerStats::add(std::int64_t arrived_ns, std::int64_t answered_ns, std::size_t batch) {
  if (first_ns_ == 0) first_ns_ = answered_ns;
  if (answers_.size() >= kMaxAnswers) answers_.pop_front();
  answers_.push_back({answered_ns, answered_ns - arrived_ns, batch});
}

AnswerSummary AnswerStats::summary(std::int64_t now_ns) {
  while (!answers_.empty() && now_ns - answers_.front().answered_ns > kWindowNs) answers_.pop_front();
  if (answers_.empty()) return {};
  std::vector<double> latencies_ms;
  double images = 0;
  for (const Answer& answer : answers_) {
    latencies_ms.push_back(static_cast<double>(answer.latency_ns) / kNsPerMs);
    images += static_cast<double>(answer.batch);
  }
  const auto count = static_cast<double>(answers_.size());
  const bool cut = answers_.size() == kMaxAnswers;  // then the window is shorter
  const std::int64_t from_ns = std::max(cut ? answers_.front().answered_ns : now_ns - kWindowNs, first_ns_);
  const double window_s = std::max(static_cast<double>(now_ns - from_ns) / kNsPerS, kLeastWindowS);
  return {count / window_s, quantile(latencies_ms, 0.5), quantile(latencies_ms, 0.99), images / count};
}

}  // namespace rtd::detector
