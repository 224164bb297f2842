// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/frame_source.hpp"

#include <numeric>
#include <utility>

namespace rtd::camera {

const char* to_string(SkipReason reason) {
  switch (reason) {
    case SkipReason::kMalformedLine:
      return "malformed_line";
    case SkipReason::kNoDepthPartner:
      return "no_depth_partner";
    case SkipReason::kStampBackwards:
      return "stamp_backwards";
    case SkipReason::kStampDoubled:
      return "stamp_doubled";
    case SkipReason::kColorUnreadable:
      return "color_unreadable";
    case SkipReason::kDepthUnreadable:
      return "depth_unreadable";
    case SkipReason::kDepthNot16Bit:
      return "depth_not_16_bit";
    case SkipReason::kSizeMismatch:
      return "size_mismatch";
    case SkipReason::kDamagedRecord:
      return "damaged_record";
    case SkipReason::kOverrun:
      return "overrun";
  }
  return "unknown";
}

std::uint64_t SourceCounters::skipped_total() const {
  return std::accumulate(skipped.begin(), skipped.end(), std::uint64_t{0});
}

void SkipLog::add(SkippedInput input) {
  ++counters_.skipped[static_cast<std::size_t>(input.reason)];
  skipped_.push_back(std::move(input));
}

void SkipLog::number(SourceFrame& frame) {
  frame.image.seq = counters_.frames++;
  if (!frame.has_depth) ++counters_.frames_without_depth;
}

std::string SkipLog::summary() const {
  if (skipped_.empty()) return {};
  std::string text = ":";
  for (std::size_t i = 0; i < kSkipReasons; ++i) {
    if (counters_.skipped[i] == 0) continue;
    text += ' ' + std::to_string(counters_.skipped[i]) + " x " + to_string(static_cast<SkipReason>(i)) + ',';
  }
  return text + " first: " + skipped_.front().detail;
}

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
