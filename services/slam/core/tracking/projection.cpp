// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/projection.hpp"

#include "services/slam/core/map/scale_pyramid.hpp"

namespace rtd::slam {

std::optional<Projection> project(const Frame& frame, const Eigen::Isometry3d& T_camera_world,
                                  const Eigen::Vector3d& p_world) {
  const Eigen::Vector3d p_camera = T_camera_world * p_world;
  if (p_camera.z() < vision::kMinProjectionDepth_m) return std::nullopt;
  const Eigen::Vector2d pixel(frame.camera.fx * p_camera.x() / p_camera.z() + frame.camera.cx,
                              frame.camera.fy * p_camera.y() / p_camera.z() + frame.camera.cy);
  if (!frame.contains(pixel)) return std::nullopt;
  return Projection{pixel, p_camera.z()};
}

std::optional<PredictedView> predict_view(const Frame& frame, const Eigen::Isometry3d& T_world_camera,
                                          const Eigen::Isometry3d& T_camera_world, const LandmarkView& landmark) {
  constexpr double kRangeSlack = 1.2;  // one octave
  const auto projection = project(frame, T_camera_world, landmark.position);
  if (!projection) return std::nullopt;
  const Eigen::Vector3d ray = landmark.position - T_world_camera.translation();
  const double distance_m = ray.norm();
  if (distance_m * kRangeSlack < landmark.min_distance_m || distance_m > landmark.max_distance_m * kRangeSlack) {
    return std::nullopt;
  }
  const double view_cosine = ray.dot(landmark.normal) / distance_m;
  if (view_cosine < kMinViewCosine) return std::nullopt;
  return PredictedView{*projection, predict_octave(landmark.max_distance_m, distance_m), view_cosine};
}

SearchPoint make_search_point(const PredictedView& view, double radius_px, const msg::Descriptor& descriptor,
                              std::uint32_t tag) {
  const auto radius = static_cast<float>(radius_px * sigma_px(view.octave));
  return {{static_cast<float>(view.projection.pixel.x()), static_cast<float>(view.projection.pixel.y()), radius,
           view.octave - 1, view.octave},
          static_cast<float>(1.0 / view.projection.z_m),
          &descriptor,
          0.0F,
          tag};
}

}  // namespace rtd::slam
