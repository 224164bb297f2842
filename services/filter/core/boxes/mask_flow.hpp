// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "services/filter/core/boxes/kalman.hpp"

namespace rtd::filter {

/// How the points on an object moved from one image to another.
struct PointsMotion {
  BoxFlow flow;
  std::vector<cv::Point2f> landed_px;  ///< where they are now, those that were found again
};

/// Median shift of a box's centre and its median change of size from points on the object; empty with fewer than
/// kMinFlowPoints.
std::optional<BoxFlow> motion_of_points(const Box& box, const std::vector<cv::Point2f>& from_px,
                                        const std::vector<cv::Point2f>& to_px);
inline constexpr std::size_t kMinFlowPoints = 6;

/// Sparse optical flow (Lucas-Kanade in pyramids) between recent images at half resolution: follows points on objects
/// without a detection. A point counts if the flow backwards leads to where it started. Bounded: the last kMaxImages
/// images. All pixels are those of the camera's own image.
class MaskFlow {
 public:
  void see(std::int64_t stamp_ns, const cv::Mat& color_bgr);
  /// Empty when one of the images is not known or too few points are found again.
  std::optional<PointsMotion> follow(std::int64_t from_ns, std::int64_t to_ns, const Box& box,
                                     const std::vector<cv::Point2f>& points_px);
  void clear() { images_.clear(); }

  static constexpr std::size_t kMaxImages = 32;

 private:
  struct Image {
    std::int64_t stamp_ns;
    cv::Mat grey;
    std::vector<cv::Mat> pyramid;  ///< made when it is first needed
  };
  Image* find(std::int64_t stamp_ns);
  std::deque<Image> images_;
};

}  // namespace rtd::filter
