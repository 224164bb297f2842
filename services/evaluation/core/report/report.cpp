// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/geometry/ply.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/input_file.hpp"
#include "common/io/text.hpp"
#include "common/service/json_text.hpp"
#include "services/evaluation/core/report/trajectory_plot.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"

namespace rtd::eval {
namespace {

constexpr std::size_t kJudgedWhenInterrupted = 50;
constexpr std::size_t kDrawnLandmarks = 8000;
constexpr char kReportPage[] = "report.html", kMapPage[] = "map.html", kDemoPage[] = "../demo.html";

std::string existing(const std::string& path) {
  return std::filesystem::is_regular_file(path) ? path : std::string();
}

std::string number(double value, const char* format, const char* unit) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) + unit : std::string("-");
}

std::string ate_text(const std::optional<Evaluation>& evaluation) {
  if (!evaluation) return "-";
  return number(evaluation->ate.error_m.rmse, "{:.4f}", " m") +
         fmt::format(" over {} poses", evaluation->ate.error_m.count);
}

std::string both_ates(const RunSummary& summary) {
  if (summary.groundtruth.empty()) return "- (no ground truth)";
  return ate_text(summary.final_trajectory) + "  (as published: " + ate_text(summary.online_trajectory) + ")";
}

/// What the source left out by reason, and where frames were lost on their way.
std::string lost_places(const Run& run) {
  std::string text;
  const auto add = [&text](const std::string& what, double count) {
    if (count > 0) text += fmt::format("{}{} {:.0f}", text.empty() ? "  (" : ", ", what, count);
  };
  add("not_played", static_cast<double>(run.frames_not_played));
  for (const auto& [reason, count] : run.left_out) add(reason, count);
  for (const auto& [place, count] : run.drops)
    if (place != "camera.skipped" || run.left_out.empty()) add(place, count);
  add("no depth in range", static_cast<double>(run.frames_out_of_range));
  return text.empty() ? text : text + ")";
}

std::string removal_text(const RunRemoval& removal) {
  const auto percent = [](double share) { return number(100 * share, "{:.1f}", " %"); };
  return "precision " + percent(removal.all.precision()) + ", recall " + percent(removal.all.recall()) +
         "  (after 1 s: " + percent(removal.settled.precision()) + ", " + percent(removal.settled.recall()) + ")";
}

/// A difference of a few milliseconds is the measurement's own error.
std::string clock_text(const run_record::HostClock& clock) {
  constexpr double kWorthReportingMs = 10;
  const bool differs = std::abs(clock.offset_ms) > kWorthReportingMs + clock.round_trip_ms / 2;
  return fmt::format("host of {} is {:.1f} ms {}, round trip {:.1f} ms{}", clock.service, std::abs(clock.offset_ms),
                     clock.offset_ms < 0 ? "behind" : "ahead", clock.round_trip_ms,
                     differs ? ": WARNING, run chrony on both hosts before comparing their times" : "");
}

std::string usage_text(const Run& run) {
  std::string text;
  double total_mb = 0;
  for (const auto& [name, process] : run.processes) {
    text += fmt::format("{}{} {:.1f} s", text.empty() ? "" : ", ", name, process.cpu_s);
    total_mb += process.peak_rss_mb;
  }
  return fmt::format("{}; peak memory together {:.0f} MB", text, total_mb);
}

using Json = nlohmann::ordered_json;

Json text_or_null(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

Json times_json(const TimeSummary& t) {
  return {{"p50", t.p50}, {"p99", t.p99}, {"max", t.max}, {"mean", t.mean}, {"count", t.count}};
}

Json stages_json(const RunSummary& summary) {
  Json stages = Json::object();
  for (const StageSummary& stage : summary.stages) stages[stage.name] = times_json(stage.ms);
  return stages;
}

void add_accuracy(const RunSummary& summary, Json& report) {
  const Evaluation none, &e = summary.final_trajectory ? *summary.final_trajectory : none;
  report["ate_rmse_m"] = e.ate.error_m.rmse;
  report["ate_poses"] = e.ate.error_m.count;
  report["rpe_trans_rmse_m"] = e.rpe_per_second.translation_m.rmse;
  report["rpe_rot_rmse_deg"] = e.rpe_per_second.rotation_rad.rmse * kRadToDeg;
  const auto& online = summary.online_trajectory;
  report["ate_online_rmse_m"] = online ? Json(online->ate.error_m.rmse) : Json(nullptr);
}

void add_processes(const Run& run, Json& report) {
  report["cpu_s"] = report["peak_rss_mb"] = report["restarts"] = Json::object();
  for (const auto& [name, usage] : run.processes) {
    report["cpu_s"][name] = usage.cpu_s;
    report["peak_rss_mb"][name] = usage.peak_rss_mb;
    report["restarts"][name] = usage.restarts;
  }
  report["deaths"] = run_record::deaths(run);
}

Json lost_json(const RunSummary& summary) {
  Json spans = Json::array();
  for (const LostFrames& span : summary.lost) {
    spans.push_back({{"first_seq", span.first_seq},
                     {"last_seq", span.last_seq},
                     {"frames", span.frames()},
                     {"start_s", span.start_s}});
  }
  return spans;
}

Json quality_json(const RemovalQuality& quality) {
  return {{"precision", quality.precision()},           {"recall", quality.recall()},
          {"removed_rightly", quality.removed_rightly}, {"removed_wrongly", quality.removed_wrongly},
          {"kept_rightly", quality.kept_rightly},       {"kept_wrongly", quality.kept_wrongly}};
}

Json integrity_json(const RunSummary& summary) {
  if (!summary.integrity) return nullptr;
  Json integrity = to_json(*summary.integrity);
  const Drift* drift = drift_of(summary);
  integrity["drift"] = drift != nullptr ? to_json(*drift) : Json(nullptr);
  integrity["scene_depth_m"] = summary.scene_depth_m ? Json(*summary.scene_depth_m) : Json(nullptr);
  return integrity;
}

std::string depth_text(const Run& run) {
  return fmt::format("median {:.2f} m, {:.0f} % of the image without", run.depth_median_m, 100 * run.depth_holes);
}

Json removal_json(const Run& run) {
  if (!run.removal) return nullptr;
  Json removal = quality_json(run.removal->all);
  removal["frames"] = run.removal->frames;
  removal["after_first_second"] = quality_json(run.removal->settled);
  return removal;
}

}  // namespace

Run load_run(const std::string& folder) {
  Run run{run_record::read_run_json(folder + "/run.json")};
  run.groundtruth_path = existing(folder + "/groundtruth.txt");
  run.trajectory_path = existing(folder + "/trajectory.txt");
  run.static_map_path = existing(folder + "/static_map.ply");
  run.pages = {{"Report", kReportPage}, {"Map in 3D", kMapPage}};
  if (!existing(folder + '/' + kDemoPage).empty()) run.pages.emplace_back("Both runs", kDemoPage);
  if (const auto map = io::try_open(run.static_map_path))
    run.static_map_points = geometry::ply_vertices(*map).value_or(0);
  if (const auto landmarks = io::try_open(folder + "/map.ply"))
    run.landmarks_m = read_landmarks(*landmarks, kDrawnLandmarks);
  return run;
}

void link_from(const std::filesystem::path& page, const std::filesystem::path& folder, Run& run) {
  std::erase_if(run.pages, [&](const auto& other) { return !std::filesystem::exists(folder / other.second); });
  for (auto& [name, place] : run.pages)
    place = std::filesystem::proximate(folder / place, std::filesystem::absolute(page).parent_path()).generic_string();
}

void judge_run(Run& run, const std::function<bool()>& go_on) {
  JudgeLimits limits;
  if (run.interrupted) limits.most_frames = kJudgedWhenInterrupted;
  limits.go_on = go_on;
  try {
    run.removal = judge_removal(run.source, run.judged_frames, limits);
  } catch (const std::exception& error) {
    run.events.push_back(std::string("masks unusable: ") + error.what());
  }
  if (run.interrupted && run.removal && run.removal->frames < run.judged_frames.size())
    run.events.push_back(
        fmt::format("interrupted: removal judged on {} of {} frames", run.removal->frames, run.judged_frames.size()));
}

void choose_trajectory(Run& run, const std::string& folder) {
  if (!existing(folder + "/trajectory_segment_2.txt").empty())
    run.events.emplace_back(
        "stamps went back: trajectory.txt has the poses before, trajectory_segment_2.txt those after");
  if (!run.trajectory_path.empty() || run.frames.empty()) return;
  run.trajectory_path = folder + "/trajectory_online.txt";
  run.events.emplace_back("slam left no trajectory.txt: judged by the poses as they were published");
}

std::string summary_text(const Run& run, const RunSummary& summary, const std::string& folder) {
  const auto row = [](const char* name, const std::string& value) { return fmt::format("  {:<12}{}\n", name, value); };
  std::string text = "\n";
  text += row("frames", summary.frames.text() + lost_places(run));
  for (const std::string& death : run_record::deaths(run)) text += row("died", death);
  text += row("coverage", number(100 * summary.coverage, "{:.1f}", " %"));
  text += row("ATE rmse", both_ates(summary));
  if (const Drift* drift = drift_of(summary); drift != nullptr && drift->nearly_constant())
    text += row("drift", explain(*drift, summary.scene_depth_m));
  if (run.depth_median_m > 0) text += row("depth", depth_text(run));
  if (run.removal) text += row("removed", removal_text(*run.removal));
  text += row("speed", number(summary.fps, "{:.1f}", " frames/s"));
  text += row("latency", fmt::format("p50 {}, p99 {}", number(summary.latency_ms.p50, "{:.1f}", " ms"),
                                     number(summary.latency_ms.p99, "{:.1f}", " ms")));
  text += row("map", fmt::format("{} keyframes, {} landmarks", summary.keyframes, summary.landmarks));
  if (!run.static_map_path.empty())
    text += row("static map", fmt::format("{} points, {}", run.static_map_points, run.static_map_path));
  for (const run_record::HostClock& clock : run.clocks) text += row("clock", clock_text(clock));
  text += row("CPU time", usage_text(run));
  for (const std::string& note : summary.notes) text += row("note", note);
  text += row("report", fmt::format("{}/{}, {}", folder, kReportPage, kMapPage));
  return text;
}

std::string comparison_text(const std::vector<ComparedRun>& runs) {
  std::string text = fmt::format("\n  {:<28}{:>26}{:>11}  frames\n", "", "ATE rmse", "coverage");
  for (const ComparedRun& compared : runs) {
    const RunSummary summary = summarize_run(compared.run);
    text += fmt::format("  {:<28}{:>26}{:>11}  {}\n", compared.label, ate_text(summary.final_trajectory),
                        number(100 * summary.coverage, "{:.1f}", " %"), summary.frames.text());
  }
  return text;
}

RunSummary write_report(const Run& run, const std::filesystem::path& folder) {
  RunSummary summary = summarize_run(run);
  const std::string json = service::json_text(report_json(run, summary));
  io::write_file(folder / "report.json", json + "\n");
  io::write_file(folder / kReportPage, report_html(run, summary));
  io::write_file(folder / kMapPage, map_page::html(map_page_of(run, summary)));
  return summary;
}

Json report_json(const Run& run, const RunSummary& summary) {
  Json report;
  report["version"] = run.version;
  report["source"] = text_or_null(run.source);
  report["pace"] = text_or_null(run.pace);
  report["filter_mode"] = text_or_null(run.filter_mode);
  report["detector"] = text_or_null(run.detector);
  report["dds"] = text_or_null(run.dds);
  report["frames_given"] = summary.frames.given;
  report["frames_in"] = run.frames_in;
  report["frames_not_played"] = run.frames_not_played;
  report["frames_used"] = summary.frames.used;
  report["frames_tracked"] = summary.frames.with_pose;
  report["frames_dropped"] = run.frames_dropped;
  report["coverage"] = summary.coverage;
  add_accuracy(summary, report);
  report["latency_ms"] = times_json(summary.latency_ms);
  report["stage_ms"] = stages_json(summary);
  add_processes(run, report);
  report["duration_s"] = run.duration_s;
  report["frames_per_s"] = summary.fps;
  report["features"] = {{"kept_mean", summary.kept_mean}, {"removed_mean", summary.removed_mean}};
  report["removal"] = removal_json(run);
  report["integrity"] = integrity_json(summary);
  report["map"] = {{"keyframes", summary.keyframes}, {"landmarks", summary.landmarks}};
  report["static_map"] = run.static_map_path.empty()
                             ? Json(nullptr)
                             : Json({{"path", run.static_map_path}, {"points", run.static_map_points}});
  report["lost_spans"] = lost_json(summary);
  report["depth"] =
      run.depth_median_m > 0 ? Json({{"median_m", run.depth_median_m}, {"holes", run.depth_holes}}) : Json(nullptr);
  report["drops"] = run.drops;
  report["left_out"] = run.left_out;
  report["clocks"] = Json::object();
  for (const run_record::HostClock& host : run.clocks)
    report["clocks"][host.service] = {{"ahead_ms", host.offset_ms}, {"round_trip_ms", host.round_trip_ms}};
  report["events"] = run.events;
  report["notes"] = summary.notes;
  report["evaluation"] = summary.final_trajectory ? to_json(*summary.final_trajectory) : Json(nullptr);
  return report;
}

}  // namespace rtd::eval
