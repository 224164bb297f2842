// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/lens_models.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>
#include <vector>

#include "common/camera/frame_source.hpp"
#include "common/io/printable.hpp"

namespace rtd::camera {
namespace {

using Parameters = geometry::CameraModel::Parameters;
using Eigen::Vector2d;

struct LensNames {
  LensModel model;
  std::string_view names;  ///< in small letters and digits only, a blank around each; no name is two blanks
};

constexpr std::array kLensNames = {
    LensNames{LensModel::kBrownConrady,
              "  plumbbob rationalpolynomial rational rationalmodel brownconrady brownconradyk6 brown radtan "
              "radialtangential perspective pinhole rectified simplepinhole simpleradial radial opencv fullopencv "},
    LensNames{LensModel::kModified, " modifiedbrownconrady modifiedbrown "},
    LensNames{LensModel::kInverse, " inversebrownconrady inversebrown "},
    LensNames{LensModel::kFisheye,
              " kannalabrandt kannalabrandt4 kannalabrandt8 kb4 equidistant equi fisheye opencvfisheye "},
    LensNames{LensModel::kNone, " none "}};

struct Bent {
  Vector2d ideal, raw;  ///< normalised
};

/// `modified`: but for r^2 the tangential part is that of the point that the radial part has moved.
Vector2d brown_conrady(const Vector2d& n, const std::array<double, 8>& k, bool modified) {
  const double r2 = n.squaredNorm();
  const Vector2d radial = n * (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))), at = modified ? radial : n;
  const double xy = 2 * at.x() * at.y();
  return radial +
         Vector2d(k[2] * xy + k[3] * (r2 + 2 * at.x() * at.x()), k[3] * xy + k[2] * (r2 + 2 * at.y() * at.y()));
}

/// Points all over the image and 5 % beyond.
std::vector<Bent> bent_points(const Parameters& camera, LensModel model) {
  constexpr int kAcross = 32, kDown = 24;
  constexpr double kMargin = 0.05;
  std::vector<Bent> points;
  for (int row = 0; row <= kDown; ++row) {
    for (int column = 0; column <= kAcross; ++column) {
      const double u = (column * (1 + 2 * kMargin) / kAcross - kMargin) * camera.width;
      const double v = (row * (1 + 2 * kMargin) / kDown - kMargin) * camera.height;
      const Vector2d n((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
      const Vector2d there = brown_conrady(n, camera.distortion, model == LensModel::kModified);
      points.push_back(model == LensModel::kInverse ? Bent{there, n} : Bent{n, there});
    }
  }
  return points;
}

/// Where the rational model puts an ideal point, and how that changes with k1 k2 p1 p2 k3 k4 k5 k6.
struct Rational {
  Vector2d raw;
  Eigen::Matrix<double, 2, 8> jacobian;
};

Rational rational_at(const Vector2d& n, const std::array<double, 8>& k) {
  const double r2 = n.squaredNorm(), r4 = r2 * r2, r6 = r4 * r2, xy = 2 * n.x() * n.y();
  const double own_x = r2 + 2 * n.x() * n.x(), own_y = r2 + 2 * n.y() * n.y();
  const double above = 1 + k[0] * r2 + k[1] * r4 + k[4] * r6, below = 1 + k[5] * r2 + k[6] * r4 + k[7] * r6;
  Rational at;
  at.raw = n * (above / below) + Vector2d(k[2] * xy + k[3] * own_x, k[3] * xy + k[2] * own_y);
  const Vector2d up = n / below, down = -n * above / (below * below);
  at.jacobian << up * r2, up * r4, Vector2d(xy, own_y), Vector2d(own_x, xy), up * r6, down * r2, down * r4, down * r6;
  return at;
}

/// One step of Gauss-Newton for the first so many coefficients.
void improve(std::array<double, 8>& k, Eigen::Index coefficients, const std::vector<Bent>& points) {
  Eigen::MatrixXd a(2 * points.size(), 8);
  Eigen::VectorXd b(2 * points.size());
  for (Eigen::Index i = 0; i < std::ssize(points); ++i) {
    const auto& [ideal, raw] = points[static_cast<std::size_t>(i)];
    const Rational at = rational_at(ideal, k);
    a.middleRows<2>(2 * i) = at.jacobian;
    b.segment<2>(2 * i) = raw - at.raw;
  }
  const Eigen::VectorXd step = a.leftCols(coefficients).colPivHouseholderQr().solve(b);
  for (Eigen::Index i = 0; i < coefficients; ++i) k[static_cast<std::size_t>(i)] += step[i];
}

double largest_error_px(const Parameters& camera, const std::vector<Bent>& points) {
  const geometry::CameraModel model(camera);
  const Vector2d f(camera.fx, camera.fy), c(camera.cx, camera.cy);
  double largest_px = 0;
  for (const auto& [ideal, raw] : points) {
    const Vector2d there = model.distort(f.cwiseProduct(ideal) + c), wanted = f.cwiseProduct(raw) + c;
    largest_px = std::max(largest_px, (there - wanted).norm());
  }
  return largest_px;
}

Parameters as_rational(const Parameters& camera, LensModel model, const std::string& origin) {
  constexpr int kRounds = 3;
  const std::vector<Bent> points = bent_points(camera, model);
  Parameters rational = camera;
  rational.distortion = {};
  improve(rational.distortion, 5, points);  // from 0 all eight would be too many
  if (largest_error_px(rational, points) < kLensFit_px) return rational;
  for (int i = 0; i < kRounds; ++i) improve(rational.distortion, 8, points);
  const bool bounded = std::ranges::all_of(rational.distortion, [](double k) { return std::abs(k) < 10; });
  if (const double error_px = largest_error_px(rational, points); !bounded || !(error_px < kLensFit_px))
    throw SourceError(
        fmt::format("{}: the lens bends the image too much for the model of OpenCV: {:.2g} px are left; "
                    "calibrate it with plumb_bob, rational_polynomial or equidistant",
                    origin, error_px));
  return rational;
}

}  // namespace

LensModel lens_model(const std::string& name) {
  std::string bare = " ";
  for (const char letter : name)
    if (std::isalnum(static_cast<unsigned char>(letter)) != 0)
      bare.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(letter))));
  bare.push_back(' ');
  const auto* const found = std::ranges::find_if(
      kLensNames, [&](const LensNames& one) { return one.names.find(bare) != std::string_view::npos; });
  return found == kLensNames.end() ? LensModel::kUnknown : found->model;
}

std::string no_such_lens(const std::string& model) {
  return "no lens model here fits '" + io::abridged(model) +
         "'; known: plumb_bob or Brown-Conrady, also inverse and modified (k1 k2 p1 p2 k3), rational_polynomial "
         "(... k4 k5 k6), equidistant, fisheye or Kannala-Brandt (k1 k2 k3 k4)";
}

Parameters with_lens(const Parameters& camera, LensModel model, const std::string& origin) {
  Parameters result = camera;
  if (model == LensModel::kNone) result.distortion = {};
  if (model == LensModel::kFisheye) result.lens = geometry::Lens::kFisheye;
  const bool bent = std::ranges::any_of(camera.distortion, [](double k) { return k != 0; });
  const bool tangential = camera.distortion[2] != 0 || camera.distortion[3] != 0;
  const bool other = (model == LensModel::kInverse && bent) || (model == LensModel::kModified && tangential);
  return other ? as_rational(camera, model, origin) : result;
}

}  // namespace rtd::camera
