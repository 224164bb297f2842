// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/report/report.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "services/evaluation/core/trajectory/evaluation.hpp"

namespace rtd::eval {
namespace {

using Json = nlohmann::ordered_json;

Json text_or_null(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

Json times_json(const TimeSummary& t) {
  return {{"p50", number_or_null(t.p50)},
          {"p99", number_or_null(t.p99)},
          {"max", number_or_null(t.max)},
          {"mean", number_or_null(t.mean)},
          {"count", t.count}};
}

Json stages_json(const RunSummary& summary) {
  Json stages = Json::object();
  for (const StageSummary& stage : summary.stages) stages[stage.name] = times_json(stage.ms);
  return stages;
}

void add_accuracy(const RunSummary& summary, Json& report) {
  const auto& final_trajectory = summary.final_trajectory;
  const auto& online = summary.online_trajectory;
  report["ate_rmse_m"] = final_trajectory ? number_or_null(final_trajectory->ate.error_m.rmse) : Json(nullptr);
  report["rpe_trans_rmse_m"] =
      final_trajectory ? number_or_null(final_trajectory->rpe_per_second.translation_m.rmse) : Json(nullptr);
  report["rpe_rot_rmse_deg"] =
      final_trajectory ? number_or_null(final_trajectory->rpe_per_second.rotation_rad.rmse * kRadToDeg) : Json(nullptr);
  report["ate_online_rmse_m"] = online ? number_or_null(online->ate.error_m.rmse) : Json(nullptr);
}

void add_processes(const Run& run, Json& report) {
  report["cpu_s"] = report["peak_rss_mb"] = report["restarts"] = Json::object();
  for (const auto& [name, usage] : run.processes) {
    report["cpu_s"][name] = number_or_null(usage.cpu_s);
    report["peak_rss_mb"][name] = number_or_null(usage.peak_rss_mb);
    report["restarts"][name] = usage.restarts;
  }
}

Json lost_json(const RunSummary& summary) {
  Json spans = Json::array();
  for (const LostFrames& span : summary.lost) {
    spans.push_back({{"first_seq", span.first_seq},
                     {"last_seq", span.last_seq},
                     {"frames", span.frames()},
                     {"start_s", number_or_null(span.start_s)}});
  }
  return spans;
}

Json clocks_json(const Run& run) {
  Json clocks = Json::object();
  for (const HostClock& host : run.clocks)
    clocks[host.service] = {{"ahead_ms", number_or_null(host.offset_ms)},
                            {"round_trip_ms", number_or_null(host.round_trip_ms)}};
  return clocks;
}

Json drops_json(const Run& run) {
  Json drops = Json::object();
  for (const auto& [place, count] : run.drops) drops[place] = number_or_null(count);
  return drops;
}

Json quality_json(const RemovalQuality& quality) {
  return {{"precision", number_or_null(quality.precision())},
          {"recall", number_or_null(quality.recall())},
          {"removed_rightly", quality.removed_rightly},
          {"removed_wrongly", quality.removed_wrongly},
          {"kept_rightly", quality.kept_rightly},
          {"kept_wrongly", quality.kept_wrongly}};
}

Json removal_json(const Run& run) {
  if (!run.removal) return nullptr;
  Json removal = quality_json(run.removal->all);
  removal["frames"] = run.removal->frames;
  removal["after_first_second"] = quality_json(run.removal->settled);
  return removal;
}

}  // namespace

Json report_json(const Run& run, const RunSummary& summary) {
  Json report;
  report["version"] = run.version;
  report["source"] = text_or_null(run.source);
  report["pace"] = text_or_null(run.pace);
  report["filter_mode"] = text_or_null(run.filter_mode);
  report["detector"] = text_or_null(run.detector);
  report["dds"] = text_or_null(run.dds);
  report["frames_in"] = run.frames_in;
  report["frames_tracked"] = summary.frames_tracked;
  report["frames_dropped"] = run.frames_dropped;
  report["coverage"] = number_or_null(summary.coverage);
  add_accuracy(summary, report);
  report["latency_ms"] = times_json(summary.latency_ms);
  report["stage_ms"] = stages_json(summary);
  add_processes(run, report);
  report["duration_s"] = number_or_null(run.duration_s);
  report["frames_per_s"] = number_or_null(summary.fps);
  report["features"] = {{"kept_mean", number_or_null(summary.kept_mean)},
                        {"removed_mean", number_or_null(summary.removed_mean)}};
  report["removal"] = removal_json(run);
  report["map"] = {{"keyframes", summary.keyframes}, {"landmarks", summary.landmarks}};
  report["static_map"] = run.static_map_path.empty()
                             ? Json(nullptr)
                             : Json({{"path", run.static_map_path}, {"points", run.static_map_points}});
  report["lost_spans"] = lost_json(summary);
  report["drops"] = drops_json(run);
  report["clocks"] = clocks_json(run);
  report["events"] = run.events;
  report["notes"] = summary.notes;
  report["evaluation"] = summary.final_trajectory ? to_json(*summary.final_trajectory) : Json(nullptr);
  return report;
}

}  // namespace rtd::eval
