// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/modes/paper_judge.hpp"

#include <cmath>
#include <numbers>

#include "common/msg/stamps.hpp"
#include "services/filter/core/motion/ego_motion.hpp"

namespace rtd::filter {
namespace {

/// Depth at an undistorted pixel, 0 = outside or not measured.
double depth_at_m(const vision::RgbdImage& image, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d raw = image.camera.distort(pixel);
  const long u = std::lround(raw.x()), v = std::lround(raw.y());
  if (u < 0 || v < 0 || u >= image.depth.cols || v >= image.depth.rows) return 0;
  return image.depth.at<std::uint16_t>(static_cast<int>(v), static_cast<int>(u)) * image.depth_scale_m;
}

double angle_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

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

CellMask cells_of_level(const Scene& scene, MotionLevel level) {
  CellMask mask(static_cast<std::size_t>(scene.shape().size()), 0);
  for (const SceneObject& object : scene.objects) {
    if (object.level != level) continue;
    for (const int cell : object.cells) mask[static_cast<std::size_t>(cell)] = 1;
  }
  return mask;
}

View view_of(const Scene& scene, const Eigen::Isometry3d& T_world_camera, const std::vector<msg::Feature>& features) {
  View view;
  view.seq = scene.image.seq;
  view.stamp_ns = scene.image.stamp_ns;
  view.T_world_camera = T_world_camera;
  view.features = features;
  return view;
}

}  // namespace

CellMask check_keypoint_depths(const vision::RgbdImage& image, const GridShape& shape,
                               const Eigen::Isometry3d& T_world_camera, const std::vector<const View*>& keyframes,
                               const PaperConfig& config) {
  constexpr double kMinDepthM = 0.1;
  const double max_angle_rad = config.max_view_angle_deg * std::numbers::pi / 180;
  CellMask moved(static_cast<std::size_t>(shape.size()), 0);
  for (const View* keyframe : keyframes) {
    const Eigen::Isometry3d T_camera_keyframe = T_world_camera.inverse() * keyframe->T_world_camera;
    for (const msg::Feature& feature : keyframe->features) {
      if (feature.depth_m <= 0) continue;
      const Eigen::Vector3d p_keyframe = image.camera.unproject({feature.u_px, feature.v_px}, feature.depth_m);
      const Eigen::Vector3d p_camera = T_camera_keyframe * p_keyframe;
      if (p_camera.z() < kMinDepthM) continue;
      const Eigen::Vector2d pixel = image.camera.project(p_camera);
      if (!image.camera.contains(pixel)) continue;
      if (angle_rad(T_camera_keyframe.linear() * p_keyframe, p_camera) > max_angle_rad) continue;
      const double measured_m = depth_at_m(image, pixel);
      if (measured_m <= 0 || p_camera.z() - measured_m <= config.tau_m) continue;
      moved[static_cast<std::size_t>(shape.nearest_cell(pixel.x(), pixel.y()))] = 1;
    }
  }
  return dilate(shape, moved, 1);
}

Verdict PaperJudge::judge(const Scene& scene, std::vector<msg::Feature> features, StageClock& clock) {
  const CellMask high = cells_of_level(scene, MotionLevel::kHigh);
  const CellMask medium = cells_of_level(scene, MotionLevel::kMedium);
  const CellMask low = cells_of_level(scene, MotionLevel::kLow);
  const RefinedPose pose = find_pose(scene, features, high);
  CellMask moved(high.size(), 0);
  if (pose.success) {
    const auto count = static_cast<std::size_t>(config_.keyframes);
    moved = check_keypoint_depths(scene.image, scene.shape(), pose.T_world_camera,
                                  views_.near_keyframes(pose.T_world_camera, {count, config_.max_baseline_m}), config_);
  }
  const auto known_of = [&](std::size_t i) {
    return CellKnowledge{high[i] != 0, medium[i] != 0, low[i] != 0, moved[i] != 0};
  };
  CellMask removed(high.size());
  for (std::size_t i = 0; i < removed.size(); ++i) removed[i] = removed_by_the_paper(known_of(i)) ? 1 : 0;
  for (msg::Feature& feature : features) {
    const auto i = static_cast<std::size_t>(scene.shape().nearest_cell(feature.u_px, feature.v_px));
    feature.flags = flags_of(known_of(i));
    mark(feature, removed[i] != 0);
  }
  views_.add(view_of(scene, pose.T_world_camera, features));
  clock.finish(msg::kStageDepthCheck);
  return {.features = std::move(features),
          .motion = to_cell_motion(removed, false),
          .T_world_camera = pose.T_world_camera,
          .pose_reliable = pose.success};
}

/// Against the frame before, as ORB-SLAM2's motion model does, with what lies outside high boxes.
RefinedPose PaperJudge::find_pose(const Scene& scene, const std::vector<msg::Feature>& features,
                                  const CellMask& high) const {
  if (views_.empty()) return {};
  const auto& p = scene.image.camera.parameters();
  const vision::FeatureGrid grid(features, p.width, p.height);
  const double window_px =
      search_window_px(scene.image.camera, msg::minus_ns(scene.image.stamp_ns, views_.newest().stamp_ns), ego_motion_);
  const Eigen::Isometry3d T_world_predicted = views_.predict_pose(scene.image.stamp_ns);
  std::vector<PointSighting> sightings;
  for (const FeatureMatch& match : match_by_projection(views_.newest(), {features, grid, scene.image.camera},
                                                       T_world_predicted, window_px, ego_motion_)) {
    const msg::Feature& f = features[match.current];
    if (!match.reference_static || high[static_cast<std::size_t>(scene.shape().nearest_cell(f.u_px, f.v_px))] != 0)
      continue;
    sightings.push_back(
        {match.p_world, {f.u_px, f.v_px}, f.depth_m, displacement_sigma_px(f.octave, scene.image.camera), -1});
  }
  const RefinedPose refined = refine_pose(sightings, scene.image.camera, T_world_predicted, ego_motion_.min_inliers);
  if (!refined.success) return {false, T_world_predicted, 0};
  return refined;
}

}  // namespace rtd::filter
