// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/depth_check.hpp"

#include <cmath>
#include <numbers>

#include "common/msg/stamps.hpp"

namespace rtd::filter {
namespace {

using Points = Eigen::Array<float, Eigen::Dynamic,
                            3>;  ///< x, y, z in a column each, so that operations on all points are vectorised

/// The cells that have a depth, as points of the camera.
struct MeasuredCells {
  std::vector<std::size_t> cell;
  Points p_camera;
};

MeasuredCells measured_cells(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays) {
  MeasuredCells measured;
  measured.cell.reserve(grid.depth_m.size());
  for (std::size_t cell = 0; cell < grid.depth_m.size(); ++cell) {
    if (grid.depth_m[cell] > 0) measured.cell.push_back(cell);
  }
  measured.p_camera.resize(static_cast<Eigen::Index>(measured.cell.size()), 3);
  for (std::size_t i = 0; i < measured.cell.size(); ++i) {
    const std::size_t cell = measured.cell[i];
    measured.p_camera.row(static_cast<Eigen::Index>(i)) = (rays[cell] * grid.depth_m[cell]).transpose().array();
  }
  return measured;
}

constexpr float kMinDepthM = 0.1F;

/// GridShape::cell_at() of many pixels, without a branch, for vector instructions; -1 for what is nearer than
/// kMinDepthM, too. The pixel (int) plus one half, times the inverse of the cell's side, never rounds to another cell.
std::vector<std::int32_t> cells_at(const Eigen::ArrayXf& u_px, const Eigen::ArrayXf& v_px, const Eigen::ArrayXf& z_m,
                                   const GridShape& shape) {
  const auto width = static_cast<float>(shape.columns * shape.cell_px);
  const auto height = static_cast<float>(shape.rows * shape.cell_px);
  const float inverse_cell = 1.0F / static_cast<float>(shape.cell_px);
  const std::int32_t columns = shape.columns;
  const auto cell = [&](float pixel, float end) {
    const float positive = pixel > 0 ? pixel : 0, inside = positive < end ? positive : end;
    return static_cast<std::int32_t>((static_cast<float>(static_cast<std::int32_t>(inside)) + 0.5F) * inverse_cell);
  };
  const auto count = static_cast<std::size_t>(u_px.size());
  std::vector<std::int32_t> cells(count);
  const float *u = u_px.data(), *v = v_px.data(), *z = z_m.data();
  std::int32_t* __restrict to = cells.data();
  for (std::size_t i = 0; i < count; ++i) {
    const bool inside = (z[i] >= kMinDepthM) & (u[i] >= 0) & (v[i] >= 0) & (u[i] < width) & (v[i] < height);
    to[i] = (cell(v[i], height) * columns + cell(u[i], width)) | (inside ? 0 : -1);
  }
  return cells;
}

// What recent views saw at a cell, while views are being compared
constexpr std::uint8_t kSeenThere = 1, kSeenThrough = 2;

/// The check against one reference view, in single precision: it runs over every cell.
class ReferenceCheck {
 public:
  ReferenceCheck(const View& view, const CameraPose& pose, const geometry::CameraModel& camera,
                 const GeometryConfig& config)
      : view_(view),
        old_(msg::minus_ns(pose.stamp_ns, view.stamp_ns) >= kOldNs),
        recent_(msg::minus_ns(pose.stamp_ns, view.stamp_ns) <= kRecentNs),
        fx_(static_cast<float>(camera.parameters().fx)),
        fy_(static_cast<float>(camera.parameters().fy)),
        cx_(static_cast<float>(camera.parameters().cx)),
        cy_(static_cast<float>(camera.parameters().cy)),
        min_cosine_(std::cos(static_cast<float>(config.max_view_angle_deg * std::numbers::pi / 180))),
        tau_floor_m_(static_cast<float>(config.tau_floor_m)),
        tau_sigmas_(static_cast<float>(config.tau_sigmas * std::numbers::sqrt2)),
        sigma_offset_m_(static_cast<float>(config.noise.offset_m)),
        sigma_factor_per_m_(static_cast<float>(config.noise.factor_per_m)) {
    const Eigen::Isometry3d T_reference_camera = view.T_world_camera.inverse() * pose.T_world_camera;
    rotation_ = T_reference_camera.linear().cast<float>();
    translation_ = T_reference_camera.translation().cast<float>();
    constexpr float kRounding = 1.01F;
    never_oblique_m_ = kRounding * translation_.norm() / std::sqrt(1 - min_cosine_ * min_cosine_);
  }

  void judge(const MeasuredCells& measured, DepthEvidence& evidence) const {
    const auto x = measured.p_camera.col(0), y = measured.p_camera.col(1), z = measured.p_camera.col(2);
    Points turned(measured.p_camera.rows(), 3);  // viewing rays of the current camera in the reference frame
    for (int k = 0; k < 3; ++k) turned.col(k) = rotation_(k, 0) * x + rotation_(k, 1) * y + rotation_(k, 2) * z;
    const Eigen::ArrayXf z_reference = turned.col(2) + translation_.z();
    const Eigen::ArrayXf u_px = fx_ * (turned.col(0) + translation_.x()) / z_reference + cx_;
    const Eigen::ArrayXf v_px = fy_ * (turned.col(1) + translation_.y()) / z_reference + cy_;
    const Eigen::ArrayXf distance2 = turned.square().rowwise().sum();
    // tau(z) = floor + k * sqrt(2) * sigma(z), Eq. (4): both depths are uncertain.
    const Eigen::ArrayXf tau =
        tau_floor_m_ + tau_sigmas_ * (sigma_offset_m_ + sigma_factor_per_m_ * z_reference * z_reference);
    const Eigen::ArrayXf nearest = z_reference - tau, farthest = z_reference + tau;
    const std::vector<std::int32_t> seen = cells_at(u_px, v_px, z_reference, view_.grid.shape);
    for (Eigen::Index i = 0; i < turned.rows(); ++i) {
      const std::int32_t there = seen[static_cast<std::size_t>(i)];
      if (there < 0 || view_.grid.near_m[static_cast<std::size_t>(there)] <= 0) continue;
      if (distance2[i] < never_oblique_m_ * never_oblique_m_ && oblique(turned.row(i))) continue;
      compare({nearest[i], farthest[i]}, static_cast<std::size_t>(there), measured.cell[static_cast<std::size_t>(i)],
              evidence);
    }
  }

 private:
  static constexpr std::int64_t kOldNs = 400'000'000, kRecentNs = 700'000'000;

  /// The depth (m) of a cell in the view, give or take its tolerance.
  struct Range {
    float nearest, farthest;
  };

  /// One cell of the current frame with the cell `i` of the view on which it falls.
  void compare(const Range& expected, std::size_t i, std::size_t cell, DepthEvidence& evidence) const {
    if (view_.grid.near_m[i] > expected.farthest) {
      ++evidence.violated[cell];
      if (recent_) evidence.settled[cell] = kSeenThrough;
    } else if (view_.grid.far_m[i] > expected.nearest) {
      if (view_.dynamic[i] == 0) ++evidence.consistent[cell];
      if (old_) ++evidence.lasting[cell];
      if (old_ && recent_ && evidence.settled[cell] == 0) evidence.settled[cell] = kSeenThere;
    }
  }

  /// Do the two viewing rays differ too much? Beyond never_oblique_m_ they cannot: sin(angle) <= baseline / distance.
  bool oblique(const Eigen::Vector3f& turned) const {
    const Eigen::Vector3f p_reference = turned + translation_;
    return turned.dot(p_reference) < min_cosine_ * turned.norm() * p_reference.norm();
  }

  const View& view_;
  bool old_, recent_;
  float fx_, fy_, cx_, cy_, min_cosine_;
  float tau_floor_m_, tau_sigmas_, sigma_offset_m_, sigma_factor_per_m_;
  float never_oblique_m_ = 0;  ///< beyond this distance no ray is oblique
  Eigen::Matrix3f rotation_;
  Eigen::Vector3f translation_;
};

}  // namespace

DepthEvidence check_depth(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& rays, const CameraPose& pose,
                          const std::vector<const View*>& references, const geometry::CameraModel& camera,
                          const GeometryConfig& config) {
  constexpr std::size_t kManyViews = 4;
  const auto cells = static_cast<std::size_t>(grid.shape.size());
  const MeasuredCells measured = measured_cells(grid, rays);
  DepthEvidence evidence = DepthEvidence::none(cells);
  for (const View* view : references) {
    if (!(view->grid.shape == grid.shape)) continue;
    const ReferenceCheck check(*view, pose, camera, config);
    check.judge(measured, evidence);
  }
  const std::size_t needed = references.size() >= kManyViews ? 2 : 1;
  for (std::size_t cell = 0; cell < cells; ++cell) {  // from counts to statements
    const bool seen_through = evidence.violated[cell] > 0;
    evidence.lasting[cell] = evidence.lasting[cell] > 0 && !seen_through ? 1 : 0;
    evidence.settled[cell] = evidence.settled[cell] == kSeenThere && seen_through ? 1 : 0;
    evidence.violated[cell] = evidence.violated[cell] >= needed ? 1 : 0;
  }
  return evidence;
}

}  // namespace rtd::filter
