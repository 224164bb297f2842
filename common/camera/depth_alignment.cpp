// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/depth_alignment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/geometry/transform_log.hpp"
#include "common/io/printable.hpp"

namespace rtd::camera {
namespace {

constexpr double kSamePixel_px = 0.5;

/// Whether two images differ in the number of pixels only, by 1 %.
bool same_shape(cv::Size a, cv::Size b) {
  constexpr double kTolerance = 0.01;
  if (a.empty() || b.empty()) return a == b;
  const double ratio = static_cast<double>(a.width) * b.height / (static_cast<double>(a.height) * b.width);
  return std::abs(ratio - 1) < kTolerance;
}

std::string text_of(const geometry::CameraModel& camera) {
  const auto& p = camera.parameters();
  return fmt::format("fx {:g} fy {:g} cx {:g} cy {:g} at {} x {} px", p.fx, p.fy, p.cx, p.cy, p.width, p.height);
}

bool named_as_registered(const std::string& topic) {
  constexpr std::array kNames = {"aligned_depth_to_color", "depth_registered", "depth_to_rgb"};
  return std::ranges::any_of(kNames, [&](const char* name) { return topic.find(name) != std::string::npos; });
}

}  // namespace

double difference_px(const geometry::CameraModel& a, const geometry::CameraModel& b) {
  const auto &p = a.parameters(), &q = b.parameters();
  double largest_px = 0;
  for (const double x : {0.0, static_cast<double>(p.width)}) {
    for (const double y : {0.0, static_cast<double>(p.height)}) {
      const Eigen::Vector2d there = b.project(a.unproject({x, y}, 1.0));
      largest_px = std::max({largest_px, std::abs(there.x() - x), std::abs(there.y() - y)});
    }
  }
  return p.width == q.width && p.height == q.height ? largest_px : INFINITY;
}

bool names_a_place(const std::string& frame_id) {
  return !geometry::bare_frame(frame_id).empty() && frame_id != "0";
}

std::string place_named(const std::string& frame_id) {
  return names_a_place(frame_id) ? geometry::bare_frame(frame_id) : std::string();
}

bool same_place(const ImageOrigin& color, const ImageOrigin& depth) {
  return names_a_place(color.frame_id) && geometry::bare_frame(color.frame_id) == geometry::bare_frame(depth.frame_id);
}

std::string of_other_camera(const ImageOrigin& followed, const std::string& frame_id) {
  if (geometry::bare_frame(frame_id) == geometry::bare_frame(followed.frame_id)) return {};
  return fmt::format("images of two cameras come on {}, in frames '{}' and '{}': those in '{}' are played",
                     followed.topic, io::abridged(followed.frame_id), io::abridged(frame_id),
                     io::abridged(followed.frame_id));
}

std::string why_unregistered(const ImageOrigin& color, const ImageOrigin& depth) {
  if (!color.size_px.empty() && !depth.size_px.empty() && color.size_px != depth.size_px) {
    return fmt::format("{} has {} px, {} has {}", depth.topic, size_text(depth.size_px), color.topic,
                       size_text(color.size_px));
  }
  if (color.camera && depth.camera && difference_px(*color.camera, *depth.camera) > kSamePixel_px) {
    return fmt::format("the camera of {} has {}, that of {} has {}", depth.topic, text_of(*depth.camera), color.topic,
                       text_of(*color.camera));
  }
  if (named_as_registered(depth.topic) || same_place(color, depth)) return {};
  const bool known = color.camera && depth.camera;  // and equal: see above
  if (known && color.topic.find("infra1") != std::string::npos) return {};
  if (geometry::bare_frame(color.frame_id) == geometry::bare_frame(depth.frame_id)) {
    return fmt::format("{} and {} are in frame '{}', which does not say where they were taken", depth.topic,
                       color.topic, color.frame_id);
  }
  return fmt::format("{} is in frame '{}', {} in '{}'", depth.topic, depth.frame_id, color.topic, color.frame_id);
}

SourceError unregistered(const std::string& source, const ImageOrigin& color, const ImageOrigin& depth,
                         const std::string& missing) {
  const std::string text = fmt::format("{}: depth is not registered to colour: {}. To register it here, {}", source,
                                       why_unregistered(color, depth), missing);
  if (!same_shape(color.size_px, depth.size_px)) return SourceError(text);
  return SourceError(text + ". If it is registered all the same: ?registered=1");
}

cv::Mat scaled_to(cv::Size color_px, const cv::Mat& depth) {
  if (depth.empty() || depth.size() == color_px || !same_shape(depth.size(), color_px)) return depth;
  cv::Mat scaled;
  cv::resize(depth, scaled, color_px, 0, 0, cv::INTER_NEAREST);  // between two surfaces there is none
  return scaled;
}

}  // namespace rtd::camera
