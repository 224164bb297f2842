// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/depth_check.hpp"

#include <cmath>
#include <numbers>

namespace rtd::filter {
namespace {

/// The check against one reference view, in single precision: it runs over every cell.
class ReferenceCheck {
 public:
  ReferenceCheck(const View& view, const CameraPose& pose, const geometry::CameraModel& camera,
                 const GeometryConfig& config)
      : view_(view),
        old_(pose.stamp_ns - view.stamp_ns >= kOldNs),
        config_(config),
        fx_(static_cast<float>(camera.parameters().fx)),
        fy_(static_cast<float>(camera.parameters().fy)),
        cx_(static_cast<float>(camera.parameters().cx)),
        cy_(static_cast<float>(camera.parameters().cy)),
        min_cosine_(std::cos(static_cast<float>(config.max_view_angle_deg * std::numbers::pi / 180))) {
    const Eigen::Isometry3d T_reference_camera = view.T_world_camera.inverse() * pose.T_world_camera;
    rotation_ = T_reference_camera.linear().cast<float>();
    translation_ = T_reference_camera.translation().cast<float>();
  }

  void judge(const Eigen::Vector3f& p_camera, std::size_t cell, DepthEvidence& evidence) const {
    const Eigen::Vector3f turned =
        rotation_ * p_camera;  // the viewing ray of the current camera in the reference frame
    const Eigen::Vector3f p_reference = turned + translation_;
    const float z = p_reference.z();
    if (z < kMinDepthM) return;
    const int seen = view_.grid.shape.cell_at(fx_ * p_reference.x() / z + cx_, fy_ * p_reference.y() / z + cy_);
    if (seen < 0) return;
    const auto i = static_cast<std::size_t>(seen);
    const float near_m = view_.grid.near_m[i], far_m = view_.grid.far_m[i];
    if (near_m <= 0 || turned.dot(p_reference) < min_cosine_ * turned.norm() * p_reference.norm()) return;
    const float tau = tolerance_m(z);
    if (near_m > z + tau) {
      ++evidence.violated[cell];
    } else if (far_m > z - tau) {
      if (view_.dynamic[i] == 0) ++evidence.consistent[cell];
      if (old_) ++evidence.lasting[cell];
    }
  }

 private:
  static constexpr float kMinDepthM = 0.1F;
  static constexpr std::int64_t kOldNs = 400'000'000;

  /// tau(z) = floor + k * sqrt(2) * sigma(z), Eq. (4): both depths are uncertain.
  float tolerance_m(float z) const {
    const auto offset = static_cast<float>(config_.noise.offset_m),
               factor = static_cast<float>(config_.noise.factor_per_m);
    const auto sigmas = static_cast<float>(config_.tau_sigmas * std::numbers::sqrt2);
    return static_cast<float>(config_.tau_floor_m) + sigmas * (offset + factor * z * z);
  }

  const View& view_;
  bool old_;
  const GeometryConfig& config_;
  float fx_, fy_, cx_, cy_, min_cosine_;
  Eigen::Matrix3f rotation_;
  Eigen::Vector3f translation_;
};

}  // namespace

DepthEvidence check_depth(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays, const CameraPose& pose,
                          const std::vector<const View*>& references, const geometry::CameraModel& camera,
                          const GeometryConfig& config) {
  constexpr std::size_t kManyViews = 4;
  const auto cells = static_cast<std::size_t>(grid.shape.size());
  DepthEvidence evidence = DepthEvidence::none(cells);
  for (const View* view : references) {
    if (!(view->grid.shape == grid.shape)) continue;
    const ReferenceCheck check(*view, pose, camera, config);
    for (std::size_t cell = 0; cell < cells; ++cell) {
      if (grid.depth_m[cell] > 0) check.judge(rays[cell] * grid.depth_m[cell], cell, evidence);
    }
  }
  const std::size_t needed = references.size() >= kManyViews ? 2 : 1;
  for (std::size_t cell = 0; cell < cells; ++cell) {  // from counts to statements
    evidence.lasting[cell] = evidence.lasting[cell] > 0 && evidence.violated[cell] == 0 ? 1 : 0;
    evidence.violated[cell] = evidence.violated[cell] >= needed ? 1 : 0;
  }
  return evidence;
}

}  // namespace rtd::filter
