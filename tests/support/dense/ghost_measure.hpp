// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "services/dense/core/depth_view.hpp"
#include "services/dense/core/static_map.hpp"
#include "services/dense/core/voxel_map.hpp"

namespace rtd::test_support {

/// What a static cloud is worth, judged by frames with true poses and true masks of what moves.
struct GhostReport {
  std::size_t points = 0;
  std::size_t judged = 0;     ///< seen by at least one frame
  std::size_t floating = 0;   ///< more frames look through it (more than 0.15 m) than find a static surface there
  std::size_t on_movers = 0;  ///< lies on a mover in some frame, on something static in none
  std::size_t ghosts() const { return floating + on_movers; }
  double ghost_share() const { return judged == 0 ? 0 : static_cast<double>(ghosts()) / static_cast<double>(judged); }
  double error_median_m = 0;  ///< of the depth of points to the static surface within 0.15 m
  double completeness = 0;    ///< share of static pixels with a point within 5 cm
};

/// Collects what single frames say of each point.
class GhostMeasure {
 public:
  explicit GhostMeasure(std::vector<dense::CloudPoint> points);
  /// `mask`: 255 = moves; empty: nothing does.
  void judge(const vision::RgbdImage& image, const cv::Mat& mask, const Eigen::Isometry3d& T_cloud_camera);
  GhostReport report() const;

 private:
  struct Votes {
    int through = 0, surface = 0, mover = 0;
  };
  void judge_points(const dense::DepthView& view, const cv::Mat& near_movers, const cv::Mat& on_movers,
                    const Eigen::Isometry3f& T_camera_cloud);
  void judge_pixels(const dense::DepthView& view, const cv::Mat& near_movers, const Eigen::Isometry3f& T_cloud_camera);

  std::vector<dense::CloudPoint> points_;
  std::vector<Votes> votes_;
  std::vector<float> errors_m_;
  dense::VoxelMap cells_;
  dense::PixelTable table_;
  std::size_t pixels_ = 0, covered_ = 0;
};

}  // namespace rtd::test_support
