// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/replay_report.hpp"

#include <fmt/format.h>

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

}  // namespace rtd::replay
