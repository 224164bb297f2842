// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "services/dense/core/static_map.hpp"

namespace rtd::dense {

/// A kept frame with copies of its images, relative to a keyframe.
struct PastView {
  vision::RgbdImage image;
  DynamicMask mask;  ///< already grown
  AnchorId anchor = kNoAnchor;
  Eigen::Isometry3d T_anchor_camera = Eigen::Isometry3d::Identity();  ///< T_world_camera without anchor
};

/// Paints what is behind the people of a frame, from earlier views. docs/theory/dense_map.md Eq. (5). One thread.
class BackgroundPainter {
 public:
  /// At most `max_views` views are kept (1.6 MB each), evenly spread over the time so far.
  BackgroundPainter(const FusionConfig& config, std::size_t max_views) : config_(config), max_views_(max_views) {}

  /// Keeps a frame that was just fused at T_world_camera.
  void remember(const vision::RgbdImage& image, const DynamicMask& mask, const Eigen::Isometry3d& T_world_camera,
                const KeyframePoses& keyframes);
  /// The newest frame with what moves in it replaced: CV_8UC4 (BGRA) in undistorted pixels, transparent where nothing
  /// is known; empty before the first. Only what the map confirms is painted.
  cv::Mat paint(StaticMap& map);

  std::size_t views() const { return views_.size(); }
  void clear();

 private:
  struct Canvas;
  Eigen::Isometry3d pose(const PastView& view, const StaticMap& map) const;
  void paint_own(const PastView& target, Canvas& canvas) const;
  void paint_view(const PastView& view, const Eigen::Isometry3d& T_world_view, const StaticMap& map,
                  Canvas& canvas) const;
  void paint_cloud(const std::vector<CloudPoint>& cloud, Canvas& canvas) const;

  FusionConfig config_;
  std::size_t max_views_;
  std::vector<PastView> views_;  ///< oldest first
  PastView newest_;
  std::uint64_t seen_ = 0, interval_ = 1;
  PixelTable table_;
};

}  // namespace rtd::dense
