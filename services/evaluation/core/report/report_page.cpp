// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/vision/jpeg_size.hpp"
#include "services/evaluation/core/report/report.hpp"
#include "services/evaluation/core/report/trajectory_plot.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"
#include "services/evaluation/page/page.hpp"

namespace rtd::eval {
namespace {

using Json = nlohmann::ordered_json;
using Frames = std::vector<run_record::FrameRecord>;

constexpr std::size_t kMostColumns = 700;  // more values are averaged: a chart has no more columns
constexpr std::size_t kMostPoses = 2000, kMostLatencies = 6000;

/// Tenths of a millimetre or millisecond: digits that no chart shows would double the page.
Json rounded(double value) {
  return std::isfinite(value) ? Json(std::round(value * 1e4) / 1e4) : Json(nullptr);
}

Json rounded(const Eigen::Vector3d& point_m) {
  return {rounded(point_m.x()), rounded(point_m.y()), rounded(point_m.z())};
}

/// The time of the source in which a run took place.
struct RunTime {
  std::int64_t start_ns = 0, end_ns = 0;
  double since_start_s(std::int64_t stamp_ns) const { return static_cast<double>(stamp_ns - start_ns) * 1e-9; }
};

RunTime run_time(const Run& run, const RunSummary& summary) {
  if (!run.frames.empty()) {
    const std::int64_t start_ns = run.frames.front().tracking.stamp_ns;
    return {start_ns, std::max(start_ns, run.frames.back().tracking.stamp_ns)};
  }
  if (summary.estimate.empty()) return {};
  return {summary.estimate.front().stamp_ns, summary.estimate.back().stamp_ns};
}

/// Columns "t" and "p", and "e" where errors are known; thinned to what a picture can show.
Json path_json(const Trajectory& poses, const RunTime& time) {
  Json path = {{"t", Json::array()}, {"p", Json::array()}};
  for (std::size_t i = 0; i < poses.size(); i += poses.size() / kMostPoses + 1) {
    path["t"].push_back(rounded(time.since_start_s(poses[i].stamp_ns)));
    path["p"].push_back(rounded(poses[i].T_world_body.translation()));
  }
  return path;
}

Json path_json(const AteResult& ate, const RunTime& time) {
  Json path = {{"t", Json::array()}, {"p", Json::array()}, {"e", Json::array()}};
  path["rmse"] = number_or_null(ate.error_m.rmse);
  path["max"] = number_or_null(ate.error_m.max);
  for (std::size_t i = 0; i < ate.points.size(); i += ate.points.size() / kMostPoses + 1) {
    path["t"].push_back(rounded(time.since_start_s(ate.points[i].stamp_ns)));
    path["p"].push_back(rounded(ate.points[i].estimate_m));
    path["e"].push_back(std::isfinite(ate.points[i].error_m) ? Json(std::round(ate.points[i].error_m * 1e6) / 1e6)
                                                             : Json(nullptr));
  }
  return path;
}

/// Features over time: [s, kept, removed, inliers], means of neighbouring frames.
Json features_json(const Frames& frames, const RunTime& time) {
  Json rows = Json::array();
  const std::size_t bucket = frames.size() / kMostColumns + 1;
  for (std::size_t begin = 0; begin < frames.size(); begin += bucket) {
    const std::size_t end = std::min(begin + bucket, frames.size());
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (std::size_t i = begin; i < end; ++i) {
      const msg::TrackingResult& result = frames[i].tracking;
      sum += Eigen::Vector4d(time.since_start_s(result.stamp_ns), result.features_static, result.features_removed,
                             result.inliers);
    }
    sum /= static_cast<double>(end - begin);
    rows.push_back({rounded(sum[0]), rounded(sum[1]), rounded(sum[2]), rounded(sum[3])});
  }
  return rows;
}

/// [s, ms] of frames with a pose; of those far above the others all.
Json latencies_json(const Run& run, const RunSummary& summary, const RunTime& time) {
  Json rows = Json::array();
  const std::size_t stride = run.frames.size() / kMostLatencies + 1;
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const auto ms = latency_ms(run.frames[i]);
    if (ms && (i % stride == 0 || *ms > 1.5 * summary.latency_ms.p99))
      rows.push_back({rounded(time.since_start_s(run.frames[i].tracking.stamp_ns)), std::round(*ms * 10) / 10});
  }
  return rows;
}

Json sample_json(const run_record::SampleFrame& sample) {
  const auto [width, height] = vision::jpeg_size(sample.jpeg);
  if (width <= 0 || height <= 0) return nullptr;
  Json json = {{"seq", sample.seq},
               {"width", width},
               {"height", height},
               {"jpeg", run_record::to_base64(sample.jpeg)},
               {"kept", Json::array()},
               {"removed", Json::array()},
               {"mask_step_px", vision::kMaskStepPx},
               {"mask_columns", sample.masks.columns},
               {"masks", run_record::to_base64(sample.masks.labels)}};
  for (const run_record::JudgedFeature& feature : sample.features)
    json[feature.removed ? "removed" : "kept"].push_back({rounded(feature.u_raw_px), rounded(feature.v_raw_px)});
  return json;
}

/// Spread evenly over those that the run kept.
Json samples_json(const Run& run, std::size_t wanted) {
  Json samples = Json::array();
  const std::size_t count = std::min(wanted, run.samples.size());
  for (std::size_t i = 0; i < count; ++i) {
    Json sample = sample_json(run.samples[(2 * i + 1) * run.samples.size() / (2 * count)]);
    if (!sample.is_null()) samples.push_back(std::move(sample));
  }
  return samples;
}

std::vector<std::string> doubtful_row(Frames::const_iterator begin, Frames::const_iterator end, const RunTime& time) {
  const double from_s = time.since_start_s(begin->tracking.stamp_ns);
  const auto range = [&](auto member) {
    const auto [least, most] = std::minmax_element(
        begin, end, [&](const auto& a, const auto& b) { return a.tracking.*member < b.tracking.*member; });
    return fmt::format("{} to {}", (*least).tracking.*member, (*most).tracking.*member);
  };
  return {fmt::format("{:.2f} s", from_s),
          fmt::format("{:.2f} s", time.since_start_s((end - 1)->tracking.stamp_ns) - from_s),
          fmt::format("{} to {}", begin->tracking.seq, (end - 1)->tracking.seq), range(&msg::TrackingResult::inliers),
          range(&msg::TrackingResult::features_removed)};
}

/// When the state was doubtful, for how long, and what was seen then.
Json doubtful_json(const Frames& frames, const RunTime& time) {
  constexpr std::size_t kShown = 20;
  Json rows = Json::array();
  std::size_t spans = 0;
  const auto is_doubtful = [](const run_record::FrameRecord& frame) {
    return frame.tracking.state == msg::TrackingState::kDoubtful;
  };
  for (auto begin = std::ranges::find_if(frames, is_doubtful); begin != frames.end();) {
    const auto end = std::find_if_not(begin, frames.end(), is_doubtful);
    if (++spans <= kShown) rows.push_back(doubtful_row(begin, end, time));
    begin = std::find_if(end, frames.end(), is_doubtful);
  }
  return {{"rows", rows}, {"more", spans - rows.size()}};
}

Json integrity_rows(const RunSummary& summary) {
  std::vector<NamedFigure> figures;
  if (summary.integrity) figures = integrity_figures(*summary.integrity);
  if (const Drift* drift = drift_of(summary)) {
    for (const NamedFigure& figure : drift_figures(*drift, summary.scene_depth_m)) figures.push_back(figure);
  }
  Json rows = Json::array();
  for (const auto& [name, value] : figures) rows.push_back({name, value});
  return rows;
}

const char* why_no_error(const RunSummary& summary) {
  if (summary.groundtruth.empty()) return "no ground truth to compare with";
  return summary.estimate.empty() ? "no poses to compare" : "poses and ground truth share no time";
}

/// What both pages show of a run.
Json run_data(const std::string& label, const Run& run, const RunSummary& summary, std::size_t samples) {
  const RunTime time = run_time(run, summary);
  const auto& final = summary.final_trajectory;
  const auto& online = summary.online_trajectory;
  return {{"label", label},
          {"pages", run.pages},
          {"report", report_json(run, summary)},
          {"frames", summary.frames.text()},
          {"why_no_error", why_no_error(summary)},
          {"span_s", time.since_start_s(time.end_ns)},
          {"truth", path_json(within(summary.groundtruth, time.start_ns, time.end_ns), time)},
          {"estimate", final ? path_json(final->ate, time) : path_json(summary.estimate, time)},
          {"online", online ? path_json(online->ate, time) : Json(nullptr)},
          {"samples", samples_json(run, samples)}};
}

}  // namespace

std::string report_html(const Run& run, const RunSummary& summary) {
  constexpr std::size_t kSamples = 24;
  const RunTime time = run_time(run, summary);
  Json data = run_data("", run, summary, kSamples);
  data["kind"] = "report";
  data["landmarks"] = Json::array();
  for (const Eigen::Vector3d& landmark : run.landmarks_m) data["landmarks"].push_back(rounded(landmark));
  data["path"] = path_json(summary.estimate, time)["p"];
  data["features"] = features_json(run.frames, time);
  data["latencies"] = latencies_json(run, summary, time);
  data["integrity"] = integrity_rows(summary);
  data["doubtful"] = doubtful_json(run.frames, time);
  return page::filled(data);
}

std::string comparison_html(const std::vector<ComparedRun>& runs) {
  constexpr std::size_t kSamples = 6;
  Json data = {{"kind", "comparison"}, {"runs", Json::array()}};
  for (const auto& [label, run] : runs) data["runs"].push_back(run_data(label, run, summarize_run(run), kSamples));
  return page::filled(data);
}

}  // namespace rtd::eval
