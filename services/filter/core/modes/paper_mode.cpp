// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/modes/paper_mode.hpp"

#include "services/filter/core/modes/keypoint_depth_check.hpp"
#include "services/filter/core/motion/guided_matching.hpp"
#include "services/filter/core/motion/sightings.hpp"

namespace rtd::filter {
namespace {

/// What is known of one cell.
struct CellKnowledge {
  bool high, medium, low, moved;
};

bool removed_by_the_paper(const CellKnowledge& cell) {
  if (cell.high) return !cell.low || cell.moved;
  if (cell.low && !cell.medium) return false;
  return cell.moved;
}

std::uint8_t flags_of(const CellKnowledge& cell) {
  unsigned flags = 0;
  if (cell.high) flags |= msg::kFeatureInHighMask;
  if (cell.medium) flags |= msg::kFeatureInMediumMask;
  if (cell.low) flags |= msg::kFeatureInLowMask;
  if (cell.moved) flags |= msg::kFeatureGeometryMoving;
  return static_cast<std::uint8_t>(flags);
}

View view_of(const PublishedInput& input, const Eigen::Isometry3d& T_world_camera,
             const std::vector<msg::Feature>& features) {
  View view;
  view.seq = input.image.seq;
  view.stamp_ns = input.image.stamp_ns;
  view.T_world_camera = T_world_camera;
  view.features = features;
  return view;
}

}  // namespace

PublishedVerdict PaperMode::judge(const PublishedInput& input, std::vector<msg::Feature>& features) {
  const CellMask high = cells_of_level(input, MotionLevel::kHigh, 0);
  const CellMask medium = cells_of_level(input, MotionLevel::kMedium, 0);
  const CellMask low = cells_of_level(input, MotionLevel::kLow, 0);
  const RefinedPose pose = find_pose(input, features, high);
  CellMask moved(high.size(), 0);
  if (pose.success) {
    const auto count = static_cast<std::size_t>(config_.keyframes);
    moved = check_keypoint_depths(input.image, input.shape, pose.T_world_camera,
                                  views_.near_keyframes(pose.T_world_camera, {count, config_.max_baseline_m}), config_);
  }
  const auto known_of = [&](std::size_t i) {
    return CellKnowledge{high[i] != 0, medium[i] != 0, low[i] != 0, moved[i] != 0};
  };
  CellMask removed(high.size());
  for (std::size_t i = 0; i < removed.size(); ++i) removed[i] = removed_by_the_paper(known_of(i)) ? 1 : 0;
  for (msg::Feature& feature : features) {
    const auto i = static_cast<std::size_t>(input.shape.nearest_cell(feature.u_px, feature.v_px));
    feature.flags = flags_of(known_of(i));
    mark(feature, removed[i] != 0);
  }
  views_.add(view_of(input, pose.T_world_camera, features));
  return {std::move(removed), pose.success, pose.T_world_camera};
}

/// Against the frame before, as ORB-SLAM2's motion model does, with what lies outside high boxes.
RefinedPose PaperMode::find_pose(const PublishedInput& input, const std::vector<msg::Feature>& features,
                                 const CellMask& high) const {
  if (views_.empty()) return {};
  const auto& p = input.image.camera.parameters();
  const vision::FeatureGrid grid(features, p.width, p.height);
  const Eigen::Isometry3d T_world_predicted = views_.predict_pose();
  std::vector<PointSighting> sightings;
  for (const FeatureMatch& match : match_by_projection(views_.newest(), {features, grid, input.image.camera},
                                                       T_world_predicted, ego_motion_.window_px, ego_motion_)) {
    const msg::Feature& f = features[match.current];
    if (!match.reference_static || high[static_cast<std::size_t>(input.shape.nearest_cell(f.u_px, f.v_px))] != 0)
      continue;
    sightings.push_back({match.p_world, {f.u_px, f.v_px}, f.depth_m, displacement_sigma_px(f.octave), -1});
  }
  const RefinedPose refined = refine_pose(sightings, input.image.camera, T_world_predicted, ego_motion_.min_inliers);
  if (!refined.success) return {false, T_world_predicted, 0};
  return refined;
}

}  // namespace rtd::filter
