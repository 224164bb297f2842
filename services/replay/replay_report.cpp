// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/replay_report.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>

namespace rtd::replay {
namespace {

const char* name_of(PlayOutcome outcome) {
  switch (outcome) {
    case PlayOutcome::kEnded:
      return "ended";
    case PlayOutcome::kStopped:
      return "stopped";
    case PlayOutcome::kUnanswered:
      return "unanswered";
  }
  return "unknown";
}

constexpr std::int64_t kRewriteEveryNs = 100'000'000;
constexpr std::size_t kCells = 20;

}  // namespace

Report report_of(const Player& player, const Outputs& outputs, const std::string& file, PlayOutcome outcome,
                 const mcap::Problems& problems) {
  Report report;
  report.file = file;
  report.outcome = name_of(outcome);
  for (const Output* output : outputs.all()) {
    report.topics.push_back({output->topic.name, output->topic.type, output->sent, output->refused});
    report.sent += output->sent;
    report.refused += output->refused;
  }
  report.resends = player.resends();
  report.timed = player.timing().count();
  report.timing_error_p50_ms = player.timing().percentile_ms(50);
  report.timing_error_p99_ms = player.timing().percentile_ms(99);
  report.timing_error_max_ms = player.timing().max_ms();
  for (const mcap::Problem& problem : problems.listed()) report.problems.push_back(mcap::to_string(problem));
  return report;
}

std::string log_text(const Report& report) {
  return fmt::format(
      "outcome={} sent={} refused={} resends={} timing_error_p50_ms={:.3f} timing_error_p99_ms={:.3f} "
      "timing_error_max_ms={:.3f}",
      report.outcome, report.sent, report.refused, report.resends, report.timing_error_p50_ms,
      report.timing_error_p99_ms, report.timing_error_max_ms);
}

nlohmann::ordered_json to_json(const Report& report) {
  nlohmann::ordered_json json = {{"file", report.file},
                                 {"outcome", report.outcome},
                                 {"sent", report.sent},
                                 {"refused", report.refused},
                                 {"resends", report.resends},
                                 {"timing_error_ms",
                                  {{"messages", report.timed},
                                   {"p50", report.timing_error_p50_ms},
                                   {"p99", report.timing_error_p99_ms},
                                   {"max", report.timing_error_max_ms}}},
                                 {"problems", report.problems}};
  json["topics"] = nlohmann::ordered_json::array();
  for (const Report::Topic& topic : report.topics)
    json["topics"].push_back(
        {{"topic", topic.name}, {"type", topic.type}, {"sent", topic.sent}, {"refused", topic.refused}});
  return json;
}

std::string status_text(const PlayState& state, std::int64_t start_ns, std::int64_t end_ns) {
  const double done_s = static_cast<double>(state.recorded_ns - start_ns) * 1e-9;
  const double whole_s = static_cast<double>(end_ns - start_ns) * 1e-9;
  const double part = whole_s > 0 ? std::clamp(done_s / whole_s, 0.0, 1.0) : 1;
  const auto cells = static_cast<std::size_t>(part * kCells);
  return fmt::format("{:.1f} of {:.1f} s [{}{}] {}, {} messages{}", done_s, whole_s, std::string(cells, '#'),
                     std::string(kCells - cells, '.'),
                     state.rate > 0 ? fmt::format("{:.2f}x", state.rate) : "as fast as possible", state.sent,
                     state.paused ? ", paused" : "");
}

StatusLine::StatusLine(std::int64_t start_ns, std::int64_t end_ns)
    : start_ns_(start_ns), end_ns_(end_ns), interactive_(isatty(STDERR_FILENO) == 1) {}

StatusLine::~StatusLine() {
  if (interactive_) std::cerr << "\r\033[K" << std::flush;
}

void StatusLine::show(const PlayState& state, std::int64_t now_ns) {
  if (!interactive_ || (now_ns < next_ns_ && state.paused == paused_)) return;
  next_ns_ = now_ns + kRewriteEveryNs;
  paused_ = state.paused;
  std::cerr << "\r\033[K" << status_text(state, start_ns_, end_ns_) << std::flush;
}

}  // namespace rtd::replay
