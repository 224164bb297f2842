// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <sstream>

#include "common/io/input_file.hpp"
#include "common/io/text.hpp"
#include "common/vision/image_codecs.hpp"
#include "common/vision/jpeg_size.hpp"
#include "services/evaluation/core/report/report.hpp"
#include "services/evaluation/core/report/trajectory_plot.hpp"
#include "services/evaluation/core/trajectory/integrity.hpp"
#include "services/evaluation/page/page.hpp"

namespace rtd::eval {
namespace {

using map_page::Layer;

constexpr map_page::Color kLandmark{79, 156, 249}, kPath{63, 208, 127}, kTruth{180, 142, 247};

Layer line(const std::string& name, map_page::Color color, const Trajectory& poses, const Eigen::Isometry3d& T_map) {
  Layer layer{.name = name, .line = true, .color = color};
  for (const geometry::StampedPose& pose : poses)
    layer.points_m.push_back((T_map * pose.T_world_body.translation()).cast<float>());
  return layer;
}

const Eigen::Isometry3d* pose_of(std::uint64_t seq, const Run& run, const Trajectory& poses) {
  constexpr std::int64_t kSameFrame_ns = 500'000;  // a file has microseconds
  const auto frame = std::ranges::find(run.frames, seq, [](const auto& each) { return each.tracking.seq; });
  if (frame == run.frames.end()) return nullptr;
  const std::int64_t stamp_ns = frame->tracking.stamp_ns;
  const auto pose = std::ranges::lower_bound(poses, stamp_ns - kSameFrame_ns, {}, &geometry::StampedPose::stamp_ns);
  return pose != poses.end() && pose->stamp_ns <= stamp_ns + kSameFrame_ns ? &pose->T_world_body : nullptr;
}

/// What the samples saw of the static scene, in the colours of their images.
Layer seen_points(const Run& run, const Trajectory& poses) {
  Layer layer{.name = "Static points"};
  for (const run_record::SampleFrame& sample : run.samples) {
    const Eigen::Isometry3d* const T_world_camera = pose_of(sample.seq, run, poses);
    if (T_world_camera == nullptr || sample.points.empty()) continue;
    const cv::Mat image = vision::decode_image(sample.jpeg).pixels;
    for (const run_record::SeenPoint& point : sample.points) {
      const float u_px = point.u_raw_px, v_px = point.v_raw_px;
      if (!(u_px >= 0 && v_px >= 0 && u_px < image.cols && v_px < image.rows)) continue;
      const auto& bgr = image.at<cv::Vec3b>(static_cast<int>(v_px), static_cast<int>(u_px));
      const Eigen::Vector3d p_camera_m = Eigen::Vector3f(point.p_camera_m.data()).cast<double>();
      layer.points_m.push_back((*T_world_camera * p_camera_m).cast<float>());
      layer.colors.push_back({bgr[2], bgr[1], bgr[0]});
    }
  }
  return layer;
}

/// Where the ground truth lies in the map; empty where nothing was aligned.
std::optional<Eigen::Isometry3d> truth_in_map(const RunSummary& summary) {
  if (!summary.final_trajectory || summary.final_trajectory->ate.error_m.count == 0) return std::nullopt;
  return summary.final_trajectory->ate.alignment.T_groundtruth_estimate.inverse();
}

}  // namespace

Layer read_static_map(std::istream& in) {
  constexpr std::size_t kVertexBytes = 19, kColorAt = 12;  // x y z, red green blue, weight
  Layer layer{.name = "Room"};
  const std::string wanted =
      "property float x\nproperty float y\nproperty float z\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nproperty float weight\n";
  std::string properties, text, format;
  std::size_t count = 0;
  while (io::get_line(in, text) && text != "end_header") {
    if (text.starts_with("property ")) properties += text + '\n';
    if (text.starts_with("format ")) format = text;
    if (text.starts_with("element vertex ")) count = std::strtoull(text.c_str() + 15, nullptr, 10);
  }
  if (properties != wanted || format != "format binary_little_endian 1.0") return layer;
  std::array<char, kVertexBytes> vertex{};
  for (std::size_t i = 0; i < count && in.read(vertex.data(), vertex.size()); ++i) {
    std::memcpy(layer.points_m.emplace_back().data(), vertex.data(), kColorAt);
    std::memcpy(layer.colors.emplace_back().data(), vertex.data() + kColorAt, 3);
  }
  return layer;
}

std::vector<Eigen::Vector3d> read_landmarks(std::istream& in, std::size_t most) {
  std::string line;
  std::size_t count = 0;
  bool is_text = false, in_header = true;
  while (in_header && io::get_line(in, line)) {
    std::istringstream words(line);
    std::string key, what;
    words >> key >> what;
    if (key == "format") is_text = what == "ascii";
    if (key == "element" && what == "vertex") words >> count;
    in_header = key != "end_header";
  }
  std::vector<Eigen::Vector3d> points_m;
  if (in_header || !is_text) return points_m;
  const std::size_t stride = count / std::max<std::size_t>(1, most) + 1;
  for (std::size_t i = 0; i < count && io::get_line(in, line); ++i) {
    Eigen::Vector3d p;
    if (i % stride != 0 || !(std::istringstream(line) >> p.x() >> p.y() >> p.z())) continue;
    if (p.allFinite()) points_m.push_back(p);
  }
  return points_m;
}

map_page::Page map_page_of(const Run& run, const RunSummary& summary) {
  map_page::Page page{.title = run.source, .z_up = run.z_up, .links = run.pages};
  page.facts = {{"Frames", summary.frames.text()}, {"Keyframes", std::to_string(summary.keyframes)}};
  if (summary.final_trajectory && summary.final_trajectory->ate.error_m.count > 0)
    page.facts.emplace_back("ATE", length_text(summary.final_trajectory->ate.error_m.rmse));
  if (const auto file = io::try_open(run.static_map_path)) page.layers.push_back(read_static_map(*file));
  if (page.layers.empty()) page.layers.push_back(seen_points(run, summary.estimate));
  std::erase_if(page.layers, [](const Layer& layer) { return layer.points_m.empty(); });
  Layer landmarks{.name = "Landmarks", .shown = page.layers.empty(), .color = kLandmark};
  for (const Eigen::Vector3d& landmark : run.landmarks_m) landmarks.points_m.push_back(landmark.cast<float>());
  page.layers.push_back(std::move(landmarks));
  page.layers.push_back(line("Path of the camera", kPath, summary.estimate, Eigen::Isometry3d::Identity()));
  if (const auto T_map_truth = truth_in_map(summary))
    page.layers.push_back(line("Ground truth", kTruth, summary.groundtruth, *T_map_truth));
  return page;
}

namespace {

using Json = nlohmann::ordered_json;
using Frames = std::vector<run_record::FrameRecord>;

constexpr std::size_t kMostColumns = 700;  // more values are averaged: a chart has no more columns
constexpr std::size_t kMostPoses = 2000, kMostLatencies = 6000;

/// Tenths of a millimetre or millisecond: digits that no chart shows would double the page.
double rounded(double value) {
  return std::round(value * 1e4) / 1e4;
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
  path["rmse"] = ate.error_m.rmse;
  path["max"] = ate.error_m.max;
  for (std::size_t i = 0; i < ate.points.size(); i += ate.points.size() / kMostPoses + 1) {
    path["t"].push_back(rounded(time.since_start_s(ate.points[i].stamp_ns)));
    path["p"].push_back(rounded(ate.points[i].estimate_m));
    path["e"].push_back(std::round(ate.points[i].error_m * 1e6) / 1e6);
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
