// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/source_parts.hpp"

#include <utility>

namespace rtd::camera {

std::optional<SkippedInput> size_mismatch(const std::string& name, const cv::Mat& color, const cv::Mat& depth,
                                          const geometry::CameraModel& camera) {
  const cv::Size calibrated(camera.parameters().width, camera.parameters().height);
  if (color.size() == calibrated && depth.size() == calibrated) return std::nullopt;
  return SkippedInput{SkipReason::kSizeMismatch, name + ": colour " + size_text(color.size()) + ", depth " +
                                                     size_text(depth.size()) + ", calibration " +
                                                     size_text(calibrated) + " px differ"};
}

SourceFrame to_frame(std::int64_t stamp_ns, cv::Mat color_bgr, cv::Mat depth, const SourceInfo& info) {
  SourceFrame frame;
  frame.has_depth = cv::countNonZero(depth) > 0;
  frame.image.stamp_ns = stamp_ns;
  frame.image.color_bgr = std::move(color_bgr);
  frame.image.depth = std::move(depth);
  frame.image.depth_scale_m = info.depth_scale_m;
  frame.image.camera = info.camera;
  return frame;
}

geometry::Trajectory poses_of_span(geometry::Trajectory poses, std::int64_t from_ns, std::int64_t to_ns) {
  std::erase_if(poses, [=](const geometry::StampedPose& pose) {
    return pose.stamp_ns < from_ns - kGroundtruthMarginNs || pose.stamp_ns > to_ns + kGroundtruthMarginNs;
  });
  return poses;
}

std::string size_text(cv::Size size_px) {
  return std::to_string(size_px.width) + " x " + std::to_string(size_px.height);
}

}  // namespace rtd::camera
