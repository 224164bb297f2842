// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/msg/features.hpp"
#include "common/vision/rgbd_image.hpp"
#include "services/filter/core/filter_config.hpp"
#include "services/filter/core/surfaces/cell_masks.hpp"
#include "services/filter/core/surfaces/object_masks.hpp"

namespace rtd::filter {

/// One frame as a published rule sees it.
struct PublishedInput {
  const vision::RgbdImage& image;
  GridShape shape;
  const std::vector<SceneObject>& objects;
};

/// What a published rule says of a frame; rules that need no pose leave it.
struct PublishedVerdict {
  CellMask removed;  ///< features on these cells are removed
  bool pose_reliable = false;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

/// Somebody else's published rule for which features move, in place of ours: for comparison. It shares what comes
/// before (features, motion levels, boxes to masks) and after (slam) with our own modes, so that only the rule differs.
/// docs/theory/dynamic_points.md "Modes".
class PublishedMode {
 public:
  virtual ~PublishedMode() = default;
  /// Flags the features of the next frame and gives them probability 1 or nearly 0: the rules know nothing between.
  virtual PublishedVerdict judge(const PublishedInput& input, std::vector<msg::Feature>& features) = 0;
  virtual void on_tracking(std::uint64_t /*seq*/, const Eigen::Isometry3d& /*T_world_camera*/) {}
  virtual void on_keyframe(std::uint64_t /*seq*/, const Eigen::Isometry3d& /*T_world_camera*/) {}
  virtual void forget_keyframe(std::uint64_t /*seq*/) {}
  virtual void reset() = 0;
};

/// The rule of a mode; null for our own modes.
std::unique_ptr<PublishedMode> make_published_mode(const FilterConfig& config);

/// The verdict of a rule that knows only static and moving.
void mark(msg::Feature& feature, bool moving);

/// The cells of the objects of one level, grown by `dilate_cells`.
CellMask cells_of_level(const PublishedInput& input, MotionLevel level, int dilate_cells);

}  // namespace rtd::filter
