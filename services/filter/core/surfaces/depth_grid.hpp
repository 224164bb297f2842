// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/vision/rgbd_image.hpp"
#include "services/filter/core/config/filter_config.hpp"

namespace rtd::filter {

/// Side of a grid cell in pixels of the undistorted image, so that the longer side has about 160 cells at any
/// resolution: 640x480 gives 160x120 cells of 4 px.
constexpr int cell_side_px(int width_px, int height_px) {
  constexpr int kCells = 160;
  return std::max(1, (std::max(width_px, height_px) + kCells / 2) / kCells);
}

/// Shape of the grids of one camera; cells are numbered row by row.
struct GridShape {
  int columns = 0, rows = 0;
  int cell_px = 4;  ///< side of a cell
  int size() const { return columns * rows; }
  int index(int column, int row) const { return row * columns + column; }
  /// Cell of an undistorted pixel, -1 outside.
  int cell_at(double u_px, double v_px) const {
    if (!(u_px >= 0 && v_px >= 0 && u_px < columns * cell_px && v_px < rows * cell_px)) return -1;
    return index(static_cast<int>(u_px) / cell_px, static_cast<int>(v_px) / cell_px);
  }
  /// The same for any position, outside ones to the nearest cell.
  int nearest_cell(double u_px, double v_px) const {
    const auto clamp = [this](double px, int count) {
      const double cell = px / cell_px;
      return cell > 0 ? static_cast<int>(std::min(cell, count - 1.0)) : 0;  // 0 for NaN
    };
    return index(clamp(u_px, columns), clamp(v_px, rows));
  }
  bool operator==(const GridShape&) const = default;
};

/// The depth image at low resolution, in undistorted pixels, with what is needed to compare it safely with another
/// view.
struct DepthGrid {
  GridShape shape;
  std::vector<float> depth_m;  ///< typical depth of the cell, 0 = not measured
  std::vector<float>
      near_m;                ///< smallest depth of the 3x3 cells around; 0 when fewer than kMinNeighbours were measured
  std::vector<float> far_m;  ///< largest one
  static constexpr int kMinNeighbours = 6;
};

/// Makes depth grids of one camera. Remembers which raw pixels a cell looks at.
class DepthGridSampler {
 public:
  /// Depth outside [min, max] counts as not measured.
  DepthGridSampler(double min_depth_m, double max_depth_m) : min_depth_m_(min_depth_m), max_depth_m_(max_depth_m) {}

  DepthGrid sample(const vision::RgbdImage& image);
  /// Mean colour of a cell, for an image like the last one; black outside of it.
  cv::Vec3b color_bgr(const vision::RgbdImage& image, std::size_t cell) const;
  /// Viewing rays of the cell centres at z = 1, for the camera of the last image.
  const std::vector<Eigen::Vector3f>& rays() const { return rays_; }

 private:
  static constexpr int kSamples = 4;
  void fit(const vision::RgbdImage& image);

  double min_depth_m_, max_depth_m_;
  geometry::CameraModel::Parameters parameters_;
  cv::Size size_;
  GridShape shape_;
  std::vector<int> pixels_;  ///< kSamples raw pixels per cell as row * width + column, -1 = outside
  std::vector<Eigen::Vector3f> rays_;
};

/// Surfaces without a depth step in them: objects without a class.
struct DepthClusters {
  GridShape shape;
  std::vector<std::int32_t> label;  ///< cluster of each cell, -1 = not measured or in a cluster that is too small
  std::vector<int> cells;           ///< number of cells of each cluster
  int count() const { return static_cast<int>(cells.size()); }
};

/// Joins neighbouring cells whose depths differ by less than the step of the config (docs/theory/dynamic_points.md Eq.
/// (2)). Clusters are numbered in the order of their first cell.
DepthClusters find_depth_clusters(const DepthGrid& grid, const ClusterConfig& config);

}  // namespace rtd::filter
