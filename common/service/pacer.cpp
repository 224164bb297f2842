// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/pacer.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/io/printable.hpp"
#include "common/service/config.hpp"

namespace rtd::service {
namespace {

constexpr const char* kPaces[] = {"realtime", "asap", "lockstep"};  // by Pace

}  // namespace

Pace parse_pace(const std::string& text) {
  const auto name = std::find(std::begin(kPaces), std::end(kPaces), text);
  if (name == std::end(kPaces))
    throw ConfigError("unknown pace '" + io::abridged(text) + "': use realtime, asap or lockstep");
  return static_cast<Pace>(name - std::begin(kPaces));
}

const char* to_string(Pace pace) {
  return kPaces[static_cast<std::size_t>(pace)];
}

Pacer::Pacer(const PacerConfig& config, std::function<std::int64_t()> now_ns)
    : config_(config), now_ns_(std::move(now_ns)) {}

PaceDecision Pacer::next(std::int64_t stamp_ns, std::size_t newer_waiting) {
  return config_.window == 0 ? by_stamp(stamp_ns, newer_waiting) : by_window(static_cast<std::size_t>(config_.window));
}

PaceDecision Pacer::drain() {
  return by_window(1);
}

PaceDecision Pacer::by_stamp(std::int64_t stamp_ns, std::size_t newer_waiting) {
  PaceDecision decision;
  if (config_.at_once) return decision;
  if (stamp_ns_ != stamp_ns) advance_timeline(stamp_ns, decision);
  const std::int64_t late_ns = now_ns_() - *due_ns_;
  if (late_ns < 0) {
    decision.action = PaceAction::kWait;
    decision.wait_ns = -late_ns;
  } else if (late_ns > config_.max_lateness_ns) {
    *due_ns_ += late_ns;
    decision.shifted_ns = late_ns;
  } else if (late_ns > config_.late_after_ns) {
    decision.late_ns = late_ns;
    if (newer_waiting > 0) {
      decision.action = PaceAction::kSkipLate;
      ++late_;
    }
  }
  return decision;
}

void Pacer::advance_timeline(std::int64_t stamp_ns, PaceDecision& decision) {
  if (!stamp_ns_) {
    due_ns_ = now_ns_();
  } else {
    const std::int64_t gap_ns = stamp_ns - *stamp_ns_;
    const std::int64_t played_ns = std::clamp<std::int64_t>(gap_ns, 0, config_.max_gap_ns);
    *due_ns_ += played_ns;
    decision.cut_gap_ns = gap_ns - played_ns;
  }
  stamp_ns_ = stamp_ns;
}

PaceDecision Pacer::by_window(std::size_t room) {
  const std::int64_t now_ns = now_ns_();
  exclude_standstill(now_ns);
  if (in_flight_.size() < room) return {};
  if (now_ns - last_progress_ns_ >= config_.result_timeout_ns) return {.action = PaceAction::kGiveUp};
  if (now_ns - last_sent_ns_ >= config_.resend_after_ns) return {.action = PaceAction::kResend};
  const std::int64_t until_ns =
      std::min(last_sent_ns_ + config_.resend_after_ns, last_progress_ns_ + config_.result_timeout_ns);
  return {.action = PaceAction::kWait, .wait_ns = until_ns - now_ns};
}

/// A process that was stopped for longer than it ever waits has missed no result.
void Pacer::exclude_standstill(std::int64_t now_ns) {
  const std::int64_t away_ns = asked_ns_ ? now_ns - *asked_ns_ : 0;
  asked_ns_ = now_ns;
  if (away_ns <= 2 * config_.resend_after_ns) return;
  last_progress_ns_ += away_ns;
  last_sent_ns_ += away_ns;
}

void Pacer::sent(std::uint64_t seq) {
  last_sent_ns_ = now_ns_();
  if (in_flight_.empty()) last_progress_ns_ = last_sent_ns_;
  in_flight_.push_back(seq);
}

void Pacer::resent() {
  last_sent_ns_ = now_ns_();
  ++resends_;
}

void Pacer::answered(std::uint64_t seq) {
  const std::size_t before = in_flight_.size();
  while (!in_flight_.empty() && in_flight_.front() <= seq) in_flight_.pop_front();
  if (in_flight_.size() == before) return;
  last_progress_ns_ = now_ns_();
  last_sent_ns_ = last_progress_ns_;  // the frames behind are being worked on: their silence starts now
}

}  // namespace rtd::service
