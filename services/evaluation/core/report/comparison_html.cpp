// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "services/evaluation/core/report/report_parts.hpp"
#include "services/evaluation/core/report/trajectory_plot.hpp"

namespace rtd::eval {
namespace {

namespace palette = plot::palette;

constexpr std::array<const char*, 5> kRunColours{palette::kRed, palette::kBlue, palette::kPurple, palette::kAmber,
                                                 palette::kGreen};

/// One run with its numbers and its colour.
struct Entry {
  std::string label;
  const Run* run = nullptr;
  RunSummary summary;
  const char* colour = palette::kBlue;

  double ate_m() const { return summary.final_trajectory ? summary.final_trajectory->ate.error_m.rmse : std::nan(""); }
};

std::vector<Entry> summarize_all(const std::vector<ComparedRun>& runs) {
  std::vector<Entry> entries;
  for (const auto& [label, run] : runs)
    entries.push_back({label, &run, summarize_run(run), kRunColours[entries.size() % kRunColours.size()]});
  return entries;
}

/// Ratio of a baseline's error to a run's error in words, empty when there is nothing to compare.
std::string against_baseline(const Entry& baseline, const Entry& entry) {
  if (&baseline == &entry) return "";
  const double ratio = baseline.ate_m() / entry.ate_m();
  if (!std::isfinite(ratio)) return "";
  if (std::abs(ratio - 1) < 0.02) return "as much as " + baseline.label;
  return ratio >= 1 ? fmt::format("{:.3g} times less than {}", ratio, baseline.label)
                    : fmt::format("{:.3g} times more than {}", 1 / ratio, baseline.label);
}

std::string headline_cards(const std::vector<Entry>& entries) {
  std::vector<html::Card> cards;
  for (const Entry& entry : entries) {
    std::string detail = std::isfinite(entry.summary.coverage)
                             ? percent_text(entry.summary.coverage) + " of frames with pose"
                             : "no frames came in";
    if (const std::string ratio = against_baseline(entries.front(), entry); !ratio.empty())
      detail = ratio + "; " + detail;
    cards.push_back(
        {length_text(entry.ate_m()), "ATE RMSE, " + entry.label, detail, html::Tone::kNeutral, entry.colour});
  }
  return html::cards(cards);
}

/// The estimate in the ground truth's world, or in its own when there is no ground truth.
PathCurve run_path(const Entry& entry) {
  PathCurve curve;
  if (entry.summary.final_trajectory) {
    for (const AtePoint& point : entry.summary.final_trajectory->ate.points) {
      curve.stamps_ns.push_back(point.stamp_ns);
      curve.points_m.push_back(point.estimate_m);
    }
  } else {
    curve = path_of(entry.summary.estimate);
  }
  curve.label = entry.label;
  if (entry.summary.final_trajectory) curve.label += ", ATE " + length_text(entry.ate_m());
  curve.colour = entry.colour;
  curve.stroke.width = 1.9;
  return curve;
}

/// Ground truth during the runs, empty when no run has one.
PathCurve truth_path(const std::vector<Entry>& entries) {
  PathCurve curve;
  for (const Entry& entry : entries) {
    if (entry.summary.groundtruth.empty()) continue;
    curve = path_of(truth_during(entry.summary, run_time(*entry.run, entry.summary)));
    break;
  }
  curve.label = "ground truth";
  curve.colour = palette::kTruth;
  curve.stroke.width = 4;
  return curve;
}

std::string paths_section(const std::vector<Entry>& entries) {
  std::vector<PathCurve> curves;
  if (PathCurve truth = truth_path(entries); !truth.points_m.empty()) curves.push_back(truth);
  for (const Entry& entry : entries) curves.push_back(run_path(entry));
  plot::Svg svg(1080, fitting_height(curves, 1080), "Trajectories of the runs");
  draw_paths(svg, {0, 0, 1080, svg.height()}, curves);
  return html::section("Trajectories",
                       "Each run is aligned to the ground truth by the one rigid motion that favours it most.",
                       svg.str());
}

std::string errors_section(const std::vector<Entry>& entries) {
  std::vector<ErrorCurve> curves;
  std::int64_t start_ns = 0;
  double duration_s = 0;
  for (const Entry& entry : entries) {
    if (!entry.summary.final_trajectory) continue;
    const RunTime time = run_time(*entry.run, entry.summary);
    if (curves.empty()) start_ns = time.start_ns;
    duration_s = std::max(duration_s, time.duration_s);
    curves.push_back({entry.label, entry.colour, &entry.summary.final_trajectory->ate});
  }
  if (curves.empty()) return "";
  plot::Svg svg(1080, 300, "Position error of the runs over time");
  draw_errors_over_time(svg, {6, 0, 1074, 300}, curves, start_ns, duration_s);
  return html::section("Error over time", "", svg.str());
}

std::vector<std::string> numbers_row(const Entry& entry) {
  const RunSummary& s = entry.summary;
  const auto& e = s.final_trajectory;
  const double nan = std::nan("");
  return {entry.label,
          length_text(entry.ate_m()),
          length_text(s.online_trajectory ? s.online_trajectory->ate.error_m.rmse : nan),
          length_text(e ? e->rpe_per_second.translation_m.rmse : nan),
          number_text(e ? e->rpe_per_second.rotation_rad.rmse * 180 / std::numbers::pi : nan, 2, "deg"),
          percent_text(s.coverage),
          number_text(s.latency_ms.p50, 1, "") + " / " + number_text(s.latency_ms.p99, 1, "ms"),
          number_text(s.removed_mean, 0, "")};
}

std::string numbers_section(const std::vector<Entry>& entries) {
  html::Table table{{"run", "ATE RMSE", "as published", "RPE per second", "rotation", "frames with pose",
                     "latency p50 / p99", "removed a frame"},
                    {}};
  for (const Entry& entry : entries) table.rows.push_back(numbers_row(entry));
  return html::section("Numbers", "", html::table(table));
}

/// Of the run that removed most: that is where there is something to see.
std::string samples_section(const std::vector<Entry>& entries) {
  const auto removed = [](const Entry& e) {
    return std::isfinite(e.summary.removed_mean) ? e.summary.removed_mean : -1.0;
  };
  const auto best =
      std::ranges::max_element(entries, [&](const Entry& a, const Entry& b) { return removed(a) < removed(b); });
  if (best == entries.end()) return "";
  const std::vector<html::Figure> figures = sample_figures(*best->run, kShownSamples);
  if (figures.empty()) return "";
  return html::section("Sample frames: " + best->label,
                       "Green: kept as static. Red: removed as dynamic. Amber: pixels of people.",
                       html::gallery(figures));
}

std::string notes_section(const std::vector<Entry>& entries) {
  std::vector<std::string> lines;
  for (const Entry& entry : entries) {
    for (const std::string& event : entry.run->events) lines.push_back(entry.label + ": " + event);
    for (const std::string& note : entry.summary.notes) lines.push_back(entry.label + ": not computed: " + note);
  }
  return lines.empty() ? "" : html::section("Events", "", html::list(lines));
}

std::string title_of(const std::vector<Entry>& entries) {
  std::string title = "RTD-SLAM:";
  for (std::size_t i = 0; i < entries.size(); ++i) title += (i == 0 ? " " : " and ") + entries[i].label;
  return title;
}

}  // namespace

std::string comparison_html(const std::vector<ComparedRun>& runs) {
  const std::vector<Entry> entries = summarize_all(runs);
  if (entries.empty()) return html::page("RTD-SLAM", "no runs to compare", "");
  return html::page(title_of(entries), runs.front().run.source,
                    headline_cards(entries) + paths_section(entries) + errors_section(entries) +
                        numbers_section(entries) + samples_section(entries) + notes_section(entries));
}

}  // namespace rtd::eval
