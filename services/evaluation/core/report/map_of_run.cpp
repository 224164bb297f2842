// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <opencv2/core.hpp>
#include <sstream>

#include "common/io/input_file.hpp"
#include "common/io/text.hpp"
#include "common/vision/image_codecs.hpp"
#include "services/evaluation/core/report/report.hpp"
#include "services/evaluation/core/report/trajectory_plot.hpp"

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

}  // namespace rtd::eval
