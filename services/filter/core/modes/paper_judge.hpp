// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "common/vision/rgbd_image.hpp"
#include "services/filter/core/config/filter_config.hpp"
#include "services/filter/core/modes/mode_judge.hpp"
#include "services/filter/core/motion/static_consensus.hpp"
#include "services/filter/core/motion/view_store.hpp"
#include "services/filter/core/surfaces/cell_masks.hpp"

namespace rtd::filter {

/// The multi-view check as the paper has it (section III-A; Bescos et al., DynaSLAM, section III-C): a keypoint x of a
/// keyframe with its depth is projected to x' in the current frame. Angle between the two viewing rays too large: no
/// statement. Projected depth - measured depth at x' > tau: the pixel x' shows something that has arrived. Returns the
/// cells of such pixels and their neighbours, so that a feature a few pixels next to x' belongs to it.
CellMask check_keypoint_depths(const vision::RgbdImage& image, const GridShape& shape,
                               const Eigen::Isometry3d& T_world_camera, const std::vector<const View*>& keyframes,
                               const PaperConfig& config);

/// The RTD-SLAM paper's own rules and thresholds, section III: whole boxes without depth masks, nothing remembered.
///
/// | the feature lies in        | it is removed                                   |
/// | a high box (person)        | always                                          |
/// | a medium box (chair, book) | when the multi-view check finds motion          |
/// | a low box (tv)             | never                                           |
/// | both a low and a high box  | when the multi-view check finds motion          |
/// | no box                     | when the multi-view check finds motion          |
class PaperJudge final : public ModeJudge {
 public:
  explicit PaperJudge(const FilterConfig& config) : config_(config.paper), ego_motion_(config.ego_motion) {}
  Verdict judge(const Scene& scene, std::vector<msg::Feature> features, StageClock& clock) override;

 private:
  RefinedPose find_pose(const Scene& scene, const std::vector<msg::Feature>& features, const CellMask& high) const;

  PaperConfig config_;
  EgoMotionConfig ego_motion_;
};

}  // namespace rtd::filter
