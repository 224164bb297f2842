// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/run/run_summary_text.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rtd::launcher {
namespace {

std::string number(double value, const char* format, const char* unit) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) + unit : std::string("-");
}

std::string ate(const std::optional<eval::Evaluation>& evaluation) {
  return evaluation ? number(evaluation->ate.error_m.rmse, "{:.4f}", " m") : "-";
}

std::string both_ates(const RunSummary& summary) {
  if (summary.groundtruth.empty()) return "- (no ground truth)";
  return ate(summary.final_trajectory) + "  (as published: " + ate(summary.online_trajectory) + ")";
}

std::string lost_places(const RunRecord& record) {
  std::string text;
  for (const auto& [place, count] : record.drops) {
    if (count > 0) text += fmt::format("{}{} {:.0f}", text.empty() ? "  (" : ", ", place, count);
  }
  return text.empty() ? text : text + ")";
}

std::string removal(const RunRemoval& removal) {
  const auto percent = [](double share) { return number(100 * share, "{:.1f}", " %"); };
  return "precision " + percent(removal.all.precision()) + ", recall " + percent(removal.all.recall()) +
         "  (after 1 s: " + percent(removal.settled.precision()) + ", " + percent(removal.settled.recall()) + ")";
}

/// Up to some ms it is the measurement's own error.
std::string clock(const HostClock& clock) {
  constexpr double kWorthTellingMs = 10;
  const bool differs = std::abs(clock.offset_ms) > kWorthTellingMs + clock.round_trip_ms / 2;
  return fmt::format("host of {} is {:.1f} ms {}, round trip {:.1f} ms{}", clock.service, std::abs(clock.offset_ms),
                     clock.offset_ms < 0 ? "behind" : "ahead", clock.round_trip_ms,
                     differs ? ": WARNING, run chrony on both hosts before comparing their times" : "");
}

std::string usage(const RunRecord& record) {
  std::string text;
  double total_mb = 0;
  for (const auto& [name, process] : record.processes) {
    text += fmt::format("{}{} {:.1f} s", text.empty() ? "" : ", ", name, process.cpu_s);
    total_mb += process.peak_rss_mb;
  }
  return fmt::format("{}; peak memory together {:.0f} MB", text, total_mb);
}

}  // namespace

std::string run_summary_text(const RunRecord& record, const RunSummary& summary, const std::string& out_dir) {
  const auto row = [](const char* name, const std::string& value) { return fmt::format("  {:<12}{}\n", name, value); };
  std::string text = "\n";
  text += row("frames", fmt::format("{} in, {} with pose, {} without answer{}", record.frames_in,
                                    summary.frames_tracked, record.frames_dropped, lost_places(record)));
  text += row("coverage", number(100 * summary.coverage, "{:.1f}", " %"));
  text += row("ATE rmse", both_ates(summary));
  if (record.removal) text += row("removed", removal(*record.removal));
  text += row("speed", number(summary.fps, "{:.1f}", " frames/s"));
  text += row("latency", fmt::format("p50 {}, p99 {}", number(summary.latency_ms.p50, "{:.1f}", " ms"),
                                     number(summary.latency_ms.p99, "{:.1f}", " ms")));
  text += row("map", fmt::format("{} keyframes, {} landmarks", summary.keyframes, summary.landmarks));
  if (!record.static_map_path.empty()) {
    text += row("static map", fmt::format("{} points, {}", record.static_map_points, record.static_map_path));
  }
  for (const HostClock& host : record.clocks) text += row("clock", clock(host));
  text += row("CPU time", usage(record));
  for (const std::string& note : summary.notes) text += row("note", note);
  text += row("report", out_dir + "/report.html");
  return text;
}

}  // namespace rtd::launcher
