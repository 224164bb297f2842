// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "common/camera/depth_figures.hpp"
#include "common/camera/frame_source.hpp"

namespace rtd::camera {

/// Measures what a camera delivers, frame by frame, for `rtd camera --preview`. Not thread-safe.
class Preview {
 public:
  void add(const SourceFrame& frame);

  std::uint64_t frames() const { return frames_; }
  /// Frames a second by their stamps; 0 with fewer than two.
  double rate_hz() const;
  /// Share of pixels without a measurement, of all frames.
  double hole_share() const;
  /// Mean time of the depth image minus that of the colour image, s.
  double depth_offset_s() const { return frames_ == 0 ? 0 : offsets_s_ / static_cast<double>(frames_); }
  /// How far the depth image lies to the right of and below the colour image, px: the shift at which edges of depth lie
  /// best on edges of colour. Empty when the scene has too few of both.
  std::optional<cv::Point2d> registration_px() const;

  /// The newest frame: colour, and next to it depth from near (red) to far (blue), black where there is none.
  cv::Mat picture() const;
  /// A line for each figure.
  std::string text(const SourceInfo& info, const SourceCounters& counters) const;

 private:
  static constexpr int kReachX = 12, kReachY = 6;  ///< px, the largest shift that is looked for
  void compare_edges(const cv::Mat& color_bgr, const cv::Mat& depth);

  std::uint64_t frames_ = 0, edge_pixels_ = 0;
  std::int64_t first_ns_ = 0, newest_ns_ = 0;
  double holes_ = 0, offsets_s_ = 0;
  DepthFigures figures_;
  /// By shift: mean strength of colour edges under the edges of depth.
  cv::Mat scores_ = cv::Mat::zeros(2 * kReachY + 1, 2 * kReachX + 1, CV_64FC1);
  cv::Mat color_, depth_;
};

}  // namespace rtd::camera
