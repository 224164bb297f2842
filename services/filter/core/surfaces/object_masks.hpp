// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/vision/detection.hpp"
#include "common/vision/motion_levels.hpp"
#include "services/filter/core/config/filter_config.hpp"
#include "services/filter/core/surfaces/cell_masks.hpp"
#include "services/filter/core/surfaces/depth_grid.hpp"

namespace rtd::filter {

using vision::MotionLevel;
using vision::MotionLevels;

/// A box in cells, ends excluded.
struct CellBox {
  int left = 0, top = 0, right = 0, bottom = 0;
  bool contains(int column, int row) const { return column >= left && column < right && row >= top && row < bottom; }
};

/// One object of this frame: a detection with the cells that it covers.
struct SceneObject {
  std::string class_name;
  float score = 0;
  MotionLevel level = MotionLevel::kHigh;
  std::vector<int> cells;        ///< ascending; what the mask covers, before dilation
  bool flat = false;             ///< no depth step around it: a picture on a wall, geometry alone decides
  int track_id = -1;             ///< the same object has the same number in every frame; -1 = not tracked
  double track_age_s = 0;        ///< since it was seen first
  bool carried = false;          ///< not detected in this frame, but carried by its track
  std::vector<int> holes;        ///< ascending; cells of its box that touch it and have no depth: hair, dark clothes
  CellBox box;                   ///< of the detection
  std::vector<int> around = {};  ///< ascending; what its mask of pixels leaves to its surroundings, in and near the box
};

/// Every cell that an object covers, measured or not.
inline void for_each_covered_cell(const SceneObject& object, const auto& visit) {
  for (const auto* cells : {&object.cells, &object.holes}) {
    for (const int cell : *cells) visit(static_cast<std::size_t>(cell));
  }
}

/// A box to cut an object from.
struct ObjectBox {
  vision::Detection detection;
  int track_id = -1;
  double track_age_s = 0;
  bool carried = false;
  double depth_m = 0;  ///< expected depth of a carried object, 0 = unknown
  BoxMask mask = {};   ///< its pixels; empty: the depth alone cuts it from its box
};

/// Detections whose class has a level and whose numbers make a box within `kAbsurdPx` of the image, the kMaxObjects
/// highest scores, best first.
std::vector<vision::Detection> usable_detections(const std::vector<vision::Detection>& detections,
                                                 const MotionLevels& levels);
/// Their places among `detections`.
std::vector<std::size_t> usable_indices(const std::vector<vision::Detection>& detections, const MotionLevels& levels);
/// Depth of what stands in the middle of a box, the nearer quarter of it; 0 = nothing measured.
double depth_in_box(const vision::Detection& box, const geometry::CameraModel& camera, const DepthGrid& grid);

/// The objects with masks: inside each box the nearest large depth cluster is the object, or of a carried box the
/// largest near its depth; the background seen through the box stays. Pixels, where an object of a high level has them,
/// choose the cluster, cut it and add the holes in them. Boxes without a level or outside the image are
/// left out, and carried ones where nothing is found.
std::vector<SceneObject> find_objects(const std::vector<ObjectBox>& boxes, const MotionLevels& levels,
                                      const geometry::CameraModel& camera, const DepthGrid& grid,
                                      const DepthClusters& clusters, const MaskConfig& config);
inline constexpr std::size_t kMaxObjects = 64;

/// The clusters with each object that is not flat as its own cluster: what it touches is then judged without it.
DepthClusters separate_objects(DepthClusters clusters, const std::vector<SceneObject>& objects);

}  // namespace rtd::filter
