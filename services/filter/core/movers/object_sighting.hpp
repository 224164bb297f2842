// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/filter/core/modes/mode_judge.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"
#include "services/filter/core/surfaces/object_masks.hpp"

namespace rtd::filter {

/// Colours by which moving objects are distinguished: hue in eight parts, pale or strong, and three greys. Brightness
/// counts only where there is no hue, because light and exposure change it.
inline constexpr int kTints = 19;
/// How much of a surface has each tint, sum 1; all 0 = unknown.
using ColorHistogram = Eigen::Matrix<double, kTints, 1>;

std::uint8_t tint_of(const cv::Vec3b& bgr);

/// Hellinger: 1 - sum sqrt(a b), 0 = the same, 1 = nothing in common; 0 if one of them is unknown.
double histogram_distance(const ColorHistogram& a, const ColorHistogram& b);

struct SeenPoint {
  Eigen::Vector3d p_camera_m;
  std::uint8_t tint = 0;
};

/// What one frame shows of an object, in the frame of its camera.
struct ObjectSighting {
  /// The filter's own track: mostly the same in every frame. None: a surface that moves, of nothing that is known; what
  /// is followed may have come there, but nothing begins.
  std::optional<std::uint32_t> source;
  std::string class_name;         ///< empty: found by its motion alone
  double score = 0;               ///< of the detector
  std::vector<SeenPoint> points;  ///< of its surface: the nearest in its box
  std::vector<SeenPoint> moving;  ///< everything in its box that moves: before, on and behind that surface
  double static_probability = 0;
  bool cut_left = false, cut_right = false;  ///< continues there behind something nearer, or beyond the border
};

/// The frame in cells.
struct SeenCells {
  const DepthGrid& grid;
  const std::vector<Eigen::Vector3f>& rays;         ///< of the cell centres at z = 1
  std::function<cv::Vec3b(std::size_t)> color_bgr;  ///< of a cell
};

/// Objects that are in view: tracked ones of a high level, others while they move, movers without a class, and surfaces
/// that move besides all of these.
std::vector<ObjectSighting> sight_objects(const std::vector<SceneObject>& objects, const Verdict& verdict,
                                          const SeenCells& seen);

}  // namespace rtd::filter
