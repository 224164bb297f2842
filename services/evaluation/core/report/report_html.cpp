// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/evaluation/core/integrity/integrity_text.hpp"
#include "services/evaluation/core/report/map_picture.hpp"
#include "services/evaluation/core/report/report_parts.hpp"
#include "services/evaluation/core/report/trajectory_plot.hpp"

namespace rtd::eval {
namespace {

using html::Card;
using html::Tone;
namespace palette = plot::palette;

constexpr std::size_t kShownLostSpans = 20;

Tone coverage_tone(double coverage) {
  if (!std::isfinite(coverage)) return Tone::kNeutral;
  if (coverage >= 0.99) return Tone::kGood;
  return coverage >= 0.9 ? Tone::kWarn : Tone::kBad;
}

const char* why_no_error(const RunSummary& summary) {
  if (summary.groundtruth.empty()) return "no ground truth to compare with";
  return summary.estimate.empty() ? "no poses to compare" : "poses and ground truth share no time";
}

Card accuracy_card(const RunSummary& summary) {
  if (!summary.final_trajectory) return {"unknown", "ATE RMSE", why_no_error(summary)};
  const auto& ate = summary.final_trajectory->ate.error_m;
  std::string detail = fmt::format("over {} poses; as published: ", ate.count);
  detail += summary.online_trajectory ? length_text(summary.online_trajectory->ate.error_m.rmse) : "unknown";
  return {length_text(ate.rmse), "ATE RMSE", detail, Tone::kNeutral};
}

Card drift_card(const RunSummary& summary) {
  if (!summary.final_trajectory) return {"unknown", "RPE per second", why_no_error(summary)};
  const RpeResult& rpe = summary.final_trajectory->rpe_per_second;
  return {length_text(rpe.translation_m.rmse), "RPE per second",
          number_text(rpe.rotation_rad.rmse * 180 / std::numbers::pi, 2, "deg") + " rotation"};
}

Card latency_card(const RunSummary& summary) {
  const TimeSummary& latency = summary.latency_ms;
  if (latency.count == 0) return {"unknown", "latency p50", "no frame was timed"};
  return {number_text(latency.p50, 1, "ms"), "latency p50",
          "camera to pose; p99 " + number_text(latency.p99, 1, "ms") + ", max " + number_text(latency.max, 1, "ms")};
}

Card removed_card(const RunSummary& summary) {
  const double per_frame = summary.kept_mean + summary.removed_mean;
  if (!(per_frame > 0)) return {"unknown", "features removed", "no features were seen"};
  return {percent_text(summary.removed_mean / per_frame), "features removed",
          number_text(summary.removed_mean, 0, "") + " of " + number_text(per_frame, 0, "") + " a frame"};
}

std::string summary_cards(const Run& run, const RunSummary& summary) {
  const Card coverage{percent_text(summary.coverage), "frames with pose", summary.frames.text(),
                      coverage_tone(summary.coverage)};
  const Card speed{number_text(summary.fps, 1, "fps"), "frames per second",
                   number_text(run.duration_s, 1, "s") + " from start to end"};
  return html::cards(
      {accuracy_card(summary), coverage, drift_card(summary), latency_card(summary), speed, removed_card(summary)});
}

std::vector<std::string> length_row(const std::string& name, const Statistics& s) {
  if (s.count == 0) return {name, "-", "-", "-", "-"};
  const LengthUnit unit = length_unit(s.rmse);
  const auto text = [&](double value_m) { return fmt::format("{:.2f}", value_m * unit.per_metre); };
  return {name + " [" + unit.name + "]", text(s.rmse), text(s.median), text(s.max), fmt::format("{}", s.count)};
}

std::vector<std::string> angle_row(const std::string& name, const Statistics& s) {
  if (s.count == 0) return {name, "-", "-", "-", "-"};
  const auto text = [&](double value_rad) { return fmt::format("{:.2f}", value_rad * kRadToDeg); };
  return {name + " [deg]", text(s.rmse), text(s.median), text(s.max), fmt::format("{}", s.count)};
}

/// ATE and RPE of an evaluation with their statistics.
html::Table accuracy_table(const Evaluation& e) {
  return {{"error", "RMSE", "median", "max", "pairs"},
          {length_row("ATE", e.ate.error_m), length_row("RPE per second", e.rpe_per_second.translation_m),
           angle_row("RPE per second", e.rpe_per_second.rotation_rad),
           length_row("RPE per frame", e.rpe_per_frame.translation_m),
           angle_row("RPE per frame", e.rpe_per_frame.rotation_rad),
           length_row("RPE per metre", e.rpe_per_metre.translation_m),
           angle_row("RPE per metre", e.rpe_per_metre.rotation_rad)}};
}

std::string trajectory_section(const RunSummary& summary, const RunTime& time) {
  if (summary.final_trajectory) {
    const Trajectory truth = truth_during(summary, time);
    const double height = fitting_height({path_of(truth)}, 700);
    plot::Svg svg(700, height, "Trajectory coloured by error");
    draw_error_path(svg, {0, 0, 700, height}, summary.final_trajectory->ate, truth);
    return html::section("Trajectory against ground truth",
                         "Final trajectory (trajectory.txt) aligned to the ground truth by one rigid motion, seen "
                         "along the axis in which the "
                         "path extends least.",
                         html::columns(svg.str(), html::table(accuracy_table(*summary.final_trajectory))));
  }
  if (summary.estimate.empty()) return html::section("Trajectory", "The run has no poses to show.", "");
  PathCurve path = path_of(summary.estimate);
  path.label = "estimate";
  path.colour = palette::kBlue;
  path.stroke.width = 2.2;
  plot::Svg svg(700, fitting_height({path}, 700), "Trajectory");
  draw_paths(svg, {0, 0, 700, svg.height()}, {path});
  return html::section("Trajectory",
                       "Without ground truth at these times the error is unknown. World frame: the first camera frame.",
                       html::columns(svg.str(), ""));
}

std::string error_section(const RunSummary& summary, const RunTime& time) {
  if (!summary.final_trajectory) return "";
  std::vector<ErrorCurve> curves;
  if (summary.online_trajectory) curves.push_back({"as published", palette::kAmber, &summary.online_trajectory->ate});
  curves.push_back({"final trajectory", palette::kBlue, &summary.final_trajectory->ate});
  plot::Svg svg(1080, 300, "Position error over time");
  draw_errors_over_time(svg, {6, 0, 1074, 300}, curves, time.start_ns, time.duration_s);
  return html::section("Error over time",
                       "As published: the pose that a robot had at that moment. Final: after later bundle adjustments.",
                       svg.str());
}

std::vector<std::string> doubtful_row(std::vector<run_record::FrameRecord>::const_iterator begin,
                                      std::vector<run_record::FrameRecord>::const_iterator end, const RunTime& time) {
  const double from_s = source_time_s(*begin, time);
  const auto range = [&](auto member) {
    const auto [least, most] = std::minmax_element(
        begin, end, [&](const auto& a, const auto& b) { return a.tracking.*member < b.tracking.*member; });
    return fmt::format("{} to {}", (*least).tracking.*member, (*most).tracking.*member);
  };
  return {fmt::format("{:.2f} s", from_s), fmt::format("{:.2f} s", source_time_s(*(end - 1), time) - from_s),
          fmt::format("{} to {}", begin->tracking.seq, (end - 1)->tracking.seq), range(&msg::TrackingResult::inliers),
          range(&msg::TrackingResult::features_removed)};
}

std::string integrity_section(const RunSummary& summary) {
  html::Table table{{"figure", "value"}, {}};
  const auto add = [&table](const std::vector<NamedFigure>& figures) {
    for (const auto& [name, value] : figures) table.rows.push_back({name, value});
  };
  if (summary.integrity) add(integrity_figures(*summary.integrity));
  if (const Drift* drift = drift_of(summary)) add(drift_figures(*drift, summary.scene_depth_m));
  if (table.rows.empty()) return "";
  return html::section("Integrity", "How far the state of a pose could be trusted when it was published.",
                       html::table(table));
}

/// When the state was doubtful, for how long, and what slam said then.
std::string doubt_section(const Run& run, const RunTime& time) {
  constexpr std::size_t kShown = 20;
  html::Table table{{"from", "for", "frames", "landmarks that agreed", "removed features"}, {}};
  std::size_t spans = 0;
  const auto is_doubtful = [](const run_record::FrameRecord& frame) {
    return frame.tracking.state == msg::TrackingState::kDoubtful;
  };
  for (auto begin = std::ranges::find_if(run.frames, is_doubtful); begin != run.frames.end();) {
    const auto end = std::find_if_not(begin, run.frames.end(), is_doubtful);
    if (++spans <= kShown) table.rows.push_back(doubtful_row(begin, end, time));
    begin = std::find_if(end, run.frames.end(), is_doubtful);
  }
  if (spans == 0) return "";
  std::vector<std::string> causes;
  std::ranges::copy_if(run.events, std::back_inserter(causes),
                       [](const std::string& event) { return event.find("doubtful") != std::string::npos; });
  if (causes.size() > 2) {
    causes = {causes.front(), fmt::format("... ({} more in the list of events)", causes.size() - 2), causes.back()};
  }
  const std::string more = spans > kShown ? fmt::format("<p class=\"note\">and {} more</p>", spans - kShown) : "";
  return html::section("Why the pose was doubtful",
                       "Too few of the matched landmarks agreed with the pose for how well it was known: something "
                       "that moves may have taken it along (docs/integrity.md).",
                       html::table(table) + more + (causes.empty() ? "" : html::list(causes)));
}

std::string map_section(const Run& run, const RunSummary& summary) {
  const std::string picture = map_picture(run.landmarks_m, summary.estimate);
  if (picture.empty()) return "";
  return html::section("Map from above", "Landmarks of the map at the end of the run, and the final trajectory.",
                       picture);
}

std::string removal_note(const Run& run) {
  if (!run.removal) return "";
  const auto words = [](const RemovalQuality& quality) {
    return percent_text(quality.precision()) + " of the removed points were on something that moved, " +
           percent_text(quality.recall()) + " of the points there were removed";
  };
  return " Against the source's true moving pixels (grown by 3 px): " + words(run.removal->all) +
         "; after the first second: " + words(run.removal->settled) + ".";
}

std::string features_section(const Run& run, const RunSummary& summary) {
  if (run.frames.empty()) return "";
  return html::section(
      "Static and dynamic points",
      "Removed points were judged to lie on something that moves; tracking never uses them." + removal_note(run),
      points_chart(run, summary));
}

std::string latency_section(const Run& run, const RunSummary& summary) {
  if (summary.latency_ms.count == 0) return "";
  return html::section("Latency", "From handing the frame to the bus until its pose is ready.",
                       latency_chart(run, summary));
}

std::string stage_section(const RunSummary& summary) {
  for (const StageSummary& stage : summary.stages) {
    if (stage.ms.count > 0) return html::section("Stage times", "", stage_chart(summary));
  }
  return "";
}

std::string samples_section(const Run& run) {
  const std::vector<html::Figure> figures = sample_figures(run, kSliderSamples);
  if (figures.empty()) return "";
  return html::section(
      "Sample frames",
      "Green: kept as static. Red: removed as dynamic. Amber: pixels of people, where masks were sent. "
      "Scroll to see the others.",
      html::slider(figures));
}

std::string processes_section(const Run& run) {
  if (run.processes.empty()) return "";
  html::Table table{{"process", "CPU time [s]", "of one core [%]", "peak memory [MB]", "restarts"}, {}};
  double cpu_s = 0, rss_mb = 0;
  const auto share = [&](double seconds) {
    return run.duration_s > 0 ? number_text(100 * seconds / run.duration_s, 0, "") : std::string("unknown");
  };
  for (const auto& [name, usage] : run.processes) {
    table.rows.push_back({name, number_text(usage.cpu_s, 1, ""), share(usage.cpu_s),
                          number_text(usage.peak_rss_mb, 0, ""), fmt::format("{}", usage.restarts)});
    cpu_s += usage.cpu_s;
    rss_mb += usage.peak_rss_mb;
  }
  table.rows.push_back({"together", number_text(cpu_s, 1, ""), share(cpu_s), number_text(rss_mb, 0, ""), ""});
  return html::section("Processes",
                       "Memory together is the sum of the peaks; shared memory counts in every process that maps it.",
                       html::table(table));
}

std::string losses_section(const Run& run, const RunSummary& summary) {
  std::vector<std::string> lines;
  for (const auto& [place, count] : run.drops) lines.push_back(fmt::format("{}: {:g} frames", place, count));
  for (std::size_t i = 0; i < std::min(summary.lost.size(), kShownLostSpans); ++i) {
    const LostFrames& span = summary.lost[i];
    lines.push_back(span.frames() == 1 ? fmt::format("frame {} without pose, at {:.2f} s", span.first_seq, span.start_s)
                                       : fmt::format("frames {} to {} without pose, from {:.2f} s", span.first_seq,
                                                     span.last_seq, span.start_s));
  }
  if (summary.lost.size() > kShownLostSpans) {
    lines.push_back(
        fmt::format("and {} more spans without pose (all in report.json)", summary.lost.size() - kShownLostSpans));
  }
  return html::section("Drops and lost spans", "", lines.empty() ? "<p class=\"note\">None.</p>\n" : html::list(lines));
}

std::string events_section(const Run& run, const RunSummary& summary) {
  std::vector<std::string> lines = run.events;
  for (const std::string& note : summary.notes) lines.push_back("not computed: " + note);
  if (lines.empty()) return "";
  return html::section("Events", "", html::list(lines));
}

std::string header_badges(const Run& run, const RunSummary& summary) {
  return html::badges(
      {{"filter", run.filter_mode},
       {"detector", run.detector},
       {"pace", run.pace},
       {"dds", run.dds},
       {"depth", run.depth_median_m > 0
                     ? fmt::format("median {:.2f} m, {:.0f} % holes", run.depth_median_m, 100 * run.depth_holes)
                     : ""},
       {"keyframes", fmt::format("{}", summary.keyframes)},
       {"landmarks", fmt::format("{}", summary.landmarks)},
       {"static map", run.static_map_path.empty() ? "" : fmt::format("{} points", run.static_map_points)},
       {"version", run.version}});
}

}  // namespace

std::string report_html(const Run& run, const RunSummary& summary) {
  const RunTime time = run_time(run, summary);
  // In a poor run, the events come first.
  const bool poor = !(summary.coverage >= 0.9);
  const std::string events = events_section(run, summary);
  return html::page("RTD-SLAM run report", run.source,
                    header_badges(run, summary) + summary_cards(run, summary) + (poor ? events : "") +
                        trajectory_section(summary, time) + error_section(summary, time) + map_section(run, summary) +
                        integrity_section(summary) + doubt_section(run, time) + samples_section(run) +
                        features_section(run, summary) + latency_section(run, summary) + stage_section(summary) +
                        processes_section(run) + losses_section(run, summary) + (poor ? "" : events));
}

}  // namespace rtd::eval
