// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/depth_registration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

#include "common/vision/lanes.hpp"

// Vectors wider than the default instruction set's are only passed to inlined functions.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace rtd::vision {
namespace {

constexpr float kNearest_m = 0.05F;         // in front of the colour camera
constexpr float kSteepest = 6;              // slope of a surface against the viewing axis: 80 degrees
constexpr float kLargestStep = 0.2F;        // between neighbours, relative: more is an edge whatever the lens
constexpr float kOverlap_px = 0.02F;        // closes the quads where their corners do not meet exactly
constexpr float kSmallestArea_px = 1e-4F;   // of a quad whose slope can be measured
constexpr float kBorder_px = 64;            // around the image: farther out nothing reaches into it
constexpr double kFieldMargin = 1.2;        // beyond the image's corners, of the squared distance from the axis
constexpr std::uint16_t kNothing = 0xFFFF;  // the nearest wins by the minimum
constexpr float kFarthest = kNothing;
constexpr int kMaxLanes = 8;
constexpr int kRowsBehind = 4;  // of an image that is one pixel wide: for four pixels

void check(const geometry::CameraModel& camera, const std::string& name) {
  const auto& p = camera.parameters();
  if (p.width > 0 && p.height > 0 && p.fx > 0 && p.fy > 0) return;
  throw std::invalid_argument("depth registration: the " + name + " camera has " + std::to_string(p.width) + " x " +
                              std::to_string(p.height) + " px, fx " + std::to_string(p.fx) + ", fy " +
                              std::to_string(p.fy));
}

Eigen::Vector3d ray_of(const geometry::CameraModel& camera, int column, int row) {
  return camera.unproject(camera.undistort(Eigen::Vector2d(column, row)), 1.0);
}

/// The squared distance from the axis, normalised, at which the lens model turns back (infinite when it does not):
/// where its image stops to move outward.
double turn_squared(geometry::CameraModel::Parameters lens) {
  constexpr double kStep = 1e-3, kFar = 10;
  lens.fx = lens.fy = 1;
  lens.cx = lens.cy = 0;
  if (lens.lens == geometry::Lens::kBrownConrady) lens.distortion[2] = lens.distortion[3] = 0;
  const geometry::CameraModel radial(lens);
  double before = 0;
  for (double r = kStep; r < kFar; r += kStep) {
    const double bent = radial.distort({r, 0}).x();
    if (bent <= before) return r * r;
    before = bent;
  }
  return std::numeric_limits<double>::infinity();
}

/// The squared distance from the axis, normalised, of the farthest pixel of the image.
double field_squared(const geometry::CameraModel& camera) {
  const int right = camera.parameters().width - 1, bottom = camera.parameters().height - 1;
  double farthest = 0;
  const auto look_at = [&](int x, int y) {
    farthest = std::max(farthest, ray_of(camera, x, y).head<2>().squaredNorm());
  };
  for (int x = 0; x <= right; ++x) {
    look_at(x, 0);
    look_at(x, bottom);
  }
  for (int y = 0; y <= bottom; ++y) {
    look_at(0, y);
    look_at(right, y);
  }
  return farthest;
}

/// Elements of a row whose pixels are processed up to kMaxLanes at a time.
std::size_t padded(int columns) {
  return static_cast<std::size_t>((columns + kMaxLanes - 1) / kMaxLanes * kMaxLanes);
}

/// A row of the depth image as the colour camera sees it, with a pixel without depth before it and behind.
struct SeenRow {
  explicit SeenRow(int columns) : u(padded(columns) + 2), v(u), z_m(u), zoom(u), units(padded(columns)) {}
  std::vector<float> u, v;           ///< px, in the colour image
  std::vector<float> z_m;            ///< along the colour camera's axis; 0 = nothing to paint
  std::vector<float> zoom;           ///< z in the depth camera / z in the colour camera
  std::vector<std::uint16_t> units;  ///< as measured
};

/// What the pixels of a row paint.
struct Quads {
  explicit Quads(int columns)
      : left(padded(columns)),
        right(left),
        top(left),
        bottom(left),
        first(left),
        nearest(left),
        larger(left),
        z(padded(columns)),
        z_u(z),
        z_v(z),
        slack(z) {}
  std::vector<std::int32_t> left, right, top, bottom;  ///< px; right and bottom are the first not painted
  std::vector<std::int32_t> first;    ///< place of the first pixel; behind the image when there is none
  std::vector<std::int32_t> nearest;  ///< depth of the first pixel, units
  std::vector<std::int32_t> larger;   ///< 1 when there are more pixels
  std::vector<float> z, z_u, z_v;     ///< depth and its slopes per px, units
  std::vector<float> slack;           ///< how much the slopes may change it, units
};

/// What lies between a pixel and its neighbours on both sides along a row or a column.
template <class Floats>
struct Step {
  Floats u, v, z_m;      ///< of the surface from one pixel to the next, px
  Floats low_u, high_u;  ///< twice the ends of the quad relative to the pixel, px
  Floats low_v, high_v;
};
template <class Floats>
struct Neighbour {
  Floats u, v, z_m;  ///< relative to the pixel
};

/// A neighbour further off than `largest_m` lies on another surface. Without neighbours a step is nominal.
template <class L, class Floats>
RTD_INLINE Step<Floats> step_between(const Neighbour<Floats>& before, const Neighbour<Floats>& after,
                                     const Floats& largest_m, const Floats& nominal_u, const Floats& nominal_v) {
  const auto has_before = L::magnitude(before.z_m) < largest_m, has_after = L::magnitude(after.z_m) < largest_m;
  const auto alone = ~(has_before | has_after);
  const Floats share = (has_before & has_after) ? L::all(0.5) : L::all(1);
  Step<Floats> step;
  step.u = share * (L::where(has_after, after.u) - L::where(has_before, before.u)) + L::where(alone, nominal_u);
  step.v = share * (L::where(has_after, after.v) - L::where(has_before, before.v)) + L::where(alone, nominal_v);
  step.z_m = share * (L::where(has_after, after.z_m) - L::where(has_before, before.z_m));
  const Floats before_u = has_before ? before.u : -step.u, after_u = has_after ? after.u : step.u;
  const Floats before_v = has_before ? before.v : -step.v, after_v = has_after ? after.v : step.v;
  step.low_u = L::lesser(Floats{}, L::lesser(before_u, after_u));
  step.high_u = L::greater(Floats{}, L::greater(before_u, after_u));
  step.low_v = L::lesser(Floats{}, L::lesser(before_v, after_v));
  step.high_v = L::greater(Floats{}, L::greater(before_v, after_v));
  return step;
}

template <class L>
RTD_INLINE Neighbour<typename L::Floats> neighbour(const SeenRow& row, std::size_t at, const typename L::Floats& u,
                                                   const typename L::Floats& v, const typename L::Floats& z_m) {
  return {L::load(&row.u[at]) - u, L::load(&row.v[at]) - v, L::load(&row.z_m[at]) - z_m};
}

/// The first pixel beyond `at`, within an image of this size.
template <class L>
RTD_INLINE typename L::Ints first_beyond(const typename L::Floats& at, float size) {
  return L::ints(L::within(at, L::all(-1), L::all(size - 1)) + 1.0F);
}

/// All the pixels of a quad, four at a time: those beyond its right end stay as they are. Most have one or two rows,
/// which are painted without asking which: the same row twice is the same.
void paint_all(const SeenRow& row, const Quads& quads, std::size_t i, std::uint16_t* nearest, int width) {
  using L = Lanes<4>;
  const float u = row.u[i + 1], v = row.v[i + 1], z_u = quads.z_u[i], z_v = quads.z_v[i];
  const L::Floats z = L::all(quads.z[i] + 0.5F), slack = L::all(quads.slack[i]), ahead = {0, 1, 2, 3};
  const int right = quads.right[i], top = quads.top[i], last = quads.bottom[i] - 1;
  const auto paint_row = [&](int x, int y) {
    const L::Floats change = z_u * (ahead + (static_cast<float>(x) - u)) + z_v * (static_cast<float>(y) - v);
    const L::Floats units = L::within(z + L::within(change, -slack, slack), L::all(1), L::all(kFarthest));
    const L::Ints inside = ahead < static_cast<float>(right - x);
    L::store_lesser(nearest + std::ptrdiff_t{y} * width + x, inside ? L::ints(units) : L::Ints{} + kNothing);
  };
  for (int x = quads.left[i]; x < right; x += 4) {
    paint_row(x, top);
    paint_row(x, last);
    for (int y = top + 1; y < last; ++y) paint_row(x, y);
  }
}

/// The first pixel of each quad, without branches: most have one. Then the larger quads.
void paint(const SeenRow& row, const Quads& quads, std::vector<std::size_t>& larger, std::uint16_t* nearest,
           int width) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < quads.z.size(); ++i) {
    std::uint16_t& to = nearest[quads.first[i]];
    to = std::min(to, static_cast<std::uint16_t>(quads.nearest[i]));
    larger[count] = i;
    count += static_cast<std::size_t>(quads.larger[i]);
  }
  for (std::size_t k = 0; k < count; ++k) paint_all(row, quads, larger[k], nearest, width);
}

}  // namespace

/// The loops over rows, for 4 and for 8 pixels at a time with the same result.
struct DepthRegistration::Kernels {
  const DepthRegistration& self;

  /// p = T_color_depth (z ray), then Eq. (1) and (2) of docs/theory/camera.md.
  template <class L>
  RTD_INLINE void project_lanes(std::size_t row, SeenRow& to) const {
    using Floats = typename L::Floats;
    const auto& c = self.color_;
    const Floats fx = L::all(c.fx), fy = L::all(c.fy), cx = L::all(c.cx), cy = L::all(c.cy);
    const Floats k1 = L::all(c.distortion[0]), k2 = L::all(c.distortion[1]), k3 = L::all(c.distortion[4]);
    const Floats p1 = L::all(c.distortion[2]), p2 = L::all(c.distortion[3]);
    const Floats k4 = L::all(c.distortion[5]), k5 = L::all(c.distortion[6]), k6 = L::all(c.distortion[7]);
    const Floats t_x = L::all(self.t_color_depth_.x()), t_y = L::all(self.t_color_depth_.y());
    const Floats t_z = L::all(self.t_color_depth_.z()), nearest = L::all(kNearest_m);
    const Floats right = L::all(c.width + kBorder_px), bottom = L::all(c.height + kBorder_px);
    const Floats scale_m = L::all(self.scale_m_), farthest = L::all(self.farthest_squared_);
    const bool fisheye = c.lens == geometry::Lens::kFisheye, distorted = self.distorted_ && !fisheye;
    const std::size_t columns = to.units.size();
    const float *const ray_x = &self.rays_[0][row * columns], *const ray_y = &self.rays_[1][row * columns];
    const float* const ray_z = &self.rays_[2][row * columns];
    for (std::size_t i = 0; i < columns; i += sizeof(Floats) / sizeof(float)) {
      const Floats units = L::load(&to.units[i]), z = units * scale_m;
      const Floats Z = L::load(&ray_z[i]) * z + t_z, inverse = 1.0F / L::greater(Z, nearest);
      const Floats x = (L::load(&ray_x[i]) * z + t_x) * inverse, y = (L::load(&ray_y[i]) * z + t_y) * inverse;
      const Floats r2 = x * x + y * y;
      Floats bent_x = x, bent_y = y;
      if (distorted) {
        const Floats xy2 = 2.0F * x * y;
        const Floats radial = (1.0F + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1.0F + r2 * (k4 + r2 * (k5 + r2 * k6)));
        bent_x = x * radial + p1 * xy2 + p2 * (r2 + 2.0F * x * x);
        bent_y = y * radial + p1 * (r2 + 2.0F * y * y) + p2 * xy2;
      }
      if (fisheye) {
        const Floats factor = fisheye_factor<L>(r2);
        bent_x = x * factor;
        bent_y = y * factor;
      }
      const Floats u = fx * bent_x + cx, v = fy * bent_y + cy;
      const auto measured = (units > 0.0F) & (units < kFarthest) & (Z > nearest) & (r2 < farthest);
      const auto seen = measured & (u > -kBorder_px) & (u < right) & (v > -kBorder_px) & (v < bottom);
      L::store(&to.u[i + 1], L::where(seen, u));
      L::store(&to.v[i + 1], L::where(seen, v));
      L::store(&to.z_m[i + 1], L::where(seen, Z));
      L::store(&to.zoom[i + 1], L::where(seen, z * inverse));
    }
  }

  /// Eq. (9) of docs/theory/camera.md, one pixel after the other.
  template <class L>
  RTD_INLINE typename L::Floats fisheye_factor(const typename L::Floats& r2) const {
    constexpr float kOnAxis = 1e-6F;
    const auto& k = self.color_.distortion;
    typename L::Floats factor = L::all(1);
    for (std::size_t i = 0; i < sizeof(factor) / sizeof(float); ++i) {
      const float r = std::sqrt(r2[i]), angle = std::atan(r);
      const double a2 = static_cast<double>(angle) * static_cast<double>(angle);
      const double stretch = 1 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3])));
      if (r > kOnAxis) factor[i] = angle * static_cast<float>(stretch) / r;
    }
    return factor;
  }

  template <class L>
  RTD_INLINE void outline_lanes(const SeenRow& above, const SeenRow& row, const SeenRow& below, Quads& quads) const {
    using Floats = typename L::Floats;
    using Ints = typename L::Ints;
    constexpr geometry::DepthNoise kNoise;
    constexpr auto kNoise_m = static_cast<float>(3 * kNoise.offset_m);
    constexpr auto kNoisePer_m = static_cast<float>(3 * kNoise.factor_per_m);
    const auto width = static_cast<float>(self.color_.width), height = static_cast<float>(self.color_.height);
    const float per_m = 1 / self.scale_m_, slope = self.slope_;
    const Eigen::Vector2f right_px = self.right_px_, down_px = self.down_px_;
    const Ints behind = Ints{} + self.color_.width * self.color_.height;
    for (std::size_t i = 0; i < quads.z.size(); i += sizeof(Floats) / sizeof(float)) {
      const Floats u = L::load(&row.u[i + 1]), v = L::load(&row.v[i + 1]), z_m = L::load(&row.z_m[i + 1]);
      if (!L::any(z_m > 0.0F)) {
        L::store(&quads.first[i], behind);
        L::store(&quads.larger[i], Ints{});
        continue;
      }
      const Floats zoom = L::load(&row.zoom[i + 1]);
      const Floats largest_m = L::lesser(slope * z_m + kNoise_m + kNoisePer_m * z_m * z_m, kLargestStep * z_m);
      const auto across = step_between<L, Floats>(neighbour<L>(row, i, u, v, z_m), neighbour<L>(row, i + 2, u, v, z_m),
                                                  largest_m, zoom * right_px.x(), zoom * right_px.y());
      const auto down =
          step_between<L, Floats>(neighbour<L>(above, i + 1, u, v, z_m), neighbour<L>(below, i + 1, u, v, z_m),
                                  largest_m, zoom * down_px.x(), zoom * down_px.y());

      const Floats area = across.u * down.v - across.v * down.u;
      const Ints has_slope = L::magnitude(area) > kSmallestArea_px;
      const Floats per_area = L::where(has_slope, per_m / (has_slope ? area : L::all(1)));
      const Floats z = z_m * per_m, slack = per_m * (L::magnitude(across.z_m) + L::magnitude(down.z_m));
      const Floats z_u = (across.z_m * down.v - down.z_m * across.v) * per_area;
      const Floats z_v = (down.z_m * across.u - across.z_m * down.u) * per_area;

      const Ints left = first_beyond<L>(u + 0.5F * (across.low_u + down.low_u) - kOverlap_px, width);
      const Ints right = first_beyond<L>(u + 0.5F * (across.high_u + down.high_u) + kOverlap_px, width);
      const Ints top = first_beyond<L>(v + 0.5F * (across.low_v + down.low_v) - kOverlap_px, height);
      const Ints bottom = first_beyond<L>(v + 0.5F * (across.high_v + down.high_v) + kOverlap_px, height);
      const Ints columns = right - left, rows = bottom - top, some = (columns > 0) & (rows > 0) & (z_m > 0.0F);
      const Floats change = L::within(z_u * (L::floats(left) - u) + z_v * (L::floats(top) - v), -slack, slack);

      L::store(&quads.first[i], some ? top * self.color_.width + left : behind);
      L::store(&quads.nearest[i], L::ints(L::within(z + change + 0.5F, L::all(1), L::all(kFarthest))));
      L::store(&quads.larger[i], some & ((columns > 1) | (rows > 1)) & 1);
      L::store(&quads.left[i], left);
      L::store(&quads.right[i], right);
      L::store(&quads.top[i], top);
      L::store(&quads.bottom[i], bottom);
      L::store(&quads.z[i], z);
      L::store(&quads.slack[i], slack);
      L::store(&quads.z_u[i], z_u);
      L::store(&quads.z_v[i], z_v);
    }
  }

  void step_4(std::size_t row, SeenRow& to) const { project_lanes<Lanes<4>>(row, to); }
  void step_4(const SeenRow& above, const SeenRow& row, const SeenRow& below, Quads& quads) const {
    outline_lanes<Lanes<4>>(above, row, below, quads);
  }
  RTD_AVX2 void step_8(std::size_t row, SeenRow& to) const { project_lanes<Lanes<8>>(row, to); }
  RTD_AVX2 void step_8(const SeenRow& above, const SeenRow& row, const SeenRow& below, Quads& quads) const {
    outline_lanes<Lanes<8>>(above, row, below, quads);
  }
  template <class... Arguments>
  void step(Arguments&&... arguments) const {
    wide ? step_8(arguments...) : step_4(arguments...);
  }
  const bool wide = wide_vectors();
};

DepthRegistration::DepthRegistration(const geometry::CameraModel& color, const geometry::CameraModel& depth,
                                     const Eigen::Isometry3d& T_color_depth, double depth_scale_m)
    : color_(color.parameters()),
      distorted_(color.distorted()),
      depth_columns_(depth.parameters().width),
      depth_rows_(depth.parameters().height),
      scale_m_(static_cast<float>(depth_scale_m)),
      t_color_depth_(T_color_depth.translation().cast<float>()) {
  check(color, "colour");
  check(depth, "depth");
  if (!T_color_depth.matrix().allFinite()) throw std::invalid_argument("depth registration: transform is not finite");
  if (!(depth_scale_m > 0)) throw std::invalid_argument("depth registration: the depth unit is not positive");
  const auto& d = depth.parameters();
  const Eigen::Matrix3d R = T_color_depth.linear();
  farthest_squared_ = static_cast<float>(std::min(kFieldMargin * field_squared(color), turn_squared(color_)));
  slope_ = std::min(kSteepest / static_cast<float>(std::min(d.fx, d.fy)), kLargestStep);
  right_px_ = (Eigen::Vector2d(color_.fx * R(0, 0), color_.fy * R(1, 0)) / d.fx).cast<float>();
  down_px_ = (Eigen::Vector2d(color_.fx * R(0, 1), color_.fy * R(1, 1)) / d.fy).cast<float>();
  const std::size_t columns = padded(d.width);
  for (std::vector<float>& axis : rays_) axis.resize(columns * static_cast<std::size_t>(d.height));
  for (int row = 0; row < d.height; ++row) {
    for (int column = 0; column < d.width; ++column) {
      const Eigen::Vector3d ray = R * ray_of(depth, column, row);
      const std::size_t at = static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column);
      rays_[0][at] = static_cast<float>(ray.x());
      rays_[1][at] = static_cast<float>(ray.y());
      rays_[2][at] = static_cast<float>(ray.z());
    }
  }
}

cv::Mat DepthRegistration::operator()(const cv::Mat& depth) const {
  if (depth.type() != CV_16UC1 || depth.size() != depth_size()) {
    throw std::invalid_argument("depth registration: the depth image is not of 16 bits and " +
                                std::to_string(depth_columns_) + " x " + std::to_string(depth_rows_) + " px");
  }
  // Behind the image is where empty quads paint and where quads of its last pixels read.
  cv::Mat nearest(color_.height + kRowsBehind, color_.width, CV_16UC1, cv::Scalar(kNothing));
  auto* const pixels = nearest.ptr<std::uint16_t>();
  std::array<SeenRow, 3> ring{SeenRow(depth.cols), SeenRow(depth.cols), SeenRow(depth.cols)};
  const SeenRow outside(depth.cols);
  Quads quads(depth.cols);
  std::vector<std::size_t> larger(quads.z.size() + 1);
  const Kernels kernels{*this};
  const auto at = [&](int row) -> SeenRow& { return ring.at(static_cast<std::size_t>(row) % ring.size()); };
  for (int next = 0; next <= depth.rows; ++next) {
    const bool is_behind = next == depth.rows;
    if (!is_behind) {
      std::copy_n(depth.ptr<std::uint16_t>(next), depth.cols, at(next).units.begin());
      kernels.step(static_cast<std::size_t>(next), at(next));
    }
    if (next == 0) continue;
    kernels.step(next == 1 ? outside : at(next - 2), at(next - 1), is_behind ? outside : at(next), quads);
    paint(at(next - 1), quads, larger, pixels, color_.width);
  }
  std::replace(pixels, pixels + nearest.total(), kNothing, std::uint16_t{0});
  return nearest.rowRange(0, color_.height);
}

}  // namespace rtd::vision
