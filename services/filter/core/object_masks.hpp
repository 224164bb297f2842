// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/vision/detection.hpp"
#include "services/filter/core/depth_clusters.hpp"
#include "services/filter/core/depth_grid.hpp"
#include "services/filter/core/filter_config.hpp"
#include "services/filter/core/motion_levels.hpp"

namespace rtd::filter {

/// One object of this frame: a detection with the cells that it covers.
struct SceneObject {
  std::string class_name;
  float score = 0;
  MotionLevel level = MotionLevel::kHigh;
  std::vector<int> cells;  ///< ascending; what the mask covers, before dilation
  bool flat = false;       ///< no depth step around it: a picture on a wall, geometry alone decides
};

/// The objects whose class has a motion level, with masks: inside each box the nearest large depth cluster is the
/// object, the background seen through the box stays. Boxes that are not finite, empty or outside the image are left
/// out; at most kMaxObjects, the highest scores first.
std::vector<SceneObject> find_objects(const std::vector<vision::Detection>& detections, const MotionLevels& levels,
                                      const geometry::CameraModel& camera, const DepthGrid& grid,
                                      const DepthClusters& clusters, const MaskConfig& config);
inline constexpr std::size_t kMaxObjects = 64;

/// The clusters with each object that is not flat as a cluster of its own: what it touches is then judged without it.
DepthClusters separate_objects(DepthClusters clusters, const std::vector<SceneObject>& objects);

}  // namespace rtd::filter
