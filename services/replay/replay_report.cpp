// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/replay_report.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "common/io/printable.hpp"

namespace rtd::replay {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kOutcomes = {"ended", "stopped", "unanswered"};  // by PlayOutcome
constexpr std::int64_t kRewriteEveryNs = 100'000'000;
constexpr std::size_t kCells = 20;

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

}  // namespace

Json report_of(const Player& player, const Outputs& outputs, const std::string& file, PlayOutcome outcome,
               const mcap::Problems& problems) {
  std::uint64_t sent = 0, refused = 0;
  Json topics = Json::array(), listed = Json::array();
  for (const auto& [name, output] : outputs.all()) {
    topics.push_back(
        {{"topic", name}, {"type", output.topic.type}, {"sent", output.sent}, {"refused", output.refused}});
    sent += output.sent;
    refused += output.refused;
  }
  for (const mcap::Problem& problem : problems.listed()) listed.push_back(mcap::to_string(problem));
  const TimingError& timing = player.timing();
  return {{"file", file},
          {"outcome", kOutcomes.at(static_cast<std::size_t>(outcome))},
          {"sent", sent},
          {"refused", refused},
          {"resends", player.resends()},
          {"timing_error_ms",
           {{"messages", timing.count()},
            {"p50", timing.percentile_ms(50)},
            {"p99", timing.percentile_ms(99)},
            {"max", timing.max_ms()}}},
          {"problems", listed},
          {"topics", topics}};
}

std::string log_text(const Json& report) {
  const auto count = [&](const char* key) { return report.at(key).get<std::uint64_t>(); };
  const auto timing = [&](const char* key) { return report.at("timing_error_ms").at(key).get<double>(); };
  return fmt::format(
      "outcome={} sent={} refused={} resends={} timing_error_p50_ms={:.3f} timing_error_p99_ms={:.3f} "
      "timing_error_max_ms={:.3f}",
      report.at("outcome").get<std::string>(), count("sent"), count("refused"), count("resends"), timing("p50"),
      timing("p99"), timing("max"));
}

StatusLine::StatusLine(std::int64_t start_ns, std::int64_t end_ns)
    : start_ns_(start_ns), end_ns_(end_ns), interactive_(isatty(STDERR_FILENO) == 1) {}

StatusLine::~StatusLine() {
  if (interactive_) io::rewrite_terminal_line("");
}

void StatusLine::show(const PlayState& state, std::int64_t now_ns) {
  if (!interactive_ || (now_ns < next_ns_ && state.paused == paused_)) return;
  next_ns_ = now_ns + kRewriteEveryNs;
  paused_ = state.paused;
  io::rewrite_terminal_line(status_text(state, start_ns_, end_ns_));
}

}  // namespace rtd::replay
