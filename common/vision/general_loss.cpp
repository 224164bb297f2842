// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/general_loss.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/vision/samples.hpp"

namespace rtd::vision {
namespace {

constexpr std::array<double, 5> kShapes{2.0, 1.5, 1.0, 0.5,
                                        0.0};  ///< below 0 outliers pull no more: nor would a bad start
constexpr double kMaxNorm = 12.0;              ///< standard deviations: search windows let nothing farther in
constexpr double kMedianChi2Pixel = 1.386, kMedianChi2Rgbd = 2.366;
constexpr double kMinScale2 = 0.25, kMaxScale2 = 4.0;

/// log of the integral of r^(dimension - 1) exp(-rho(r^2) / 2) over [0, kMaxNorm], by Simpson's rule.
double log_partition(double shape, int dimension) {
  constexpr int kSteps = 600;
  const GeneralLoss loss{shape, 1.0};
  const double step = kMaxNorm / kSteps;
  double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double r = step * i, weight = i == 0 || i == kSteps ? 1 : (i % 2 == 1 ? 4 : 2);
    sum += weight * std::pow(r, dimension - 1) * std::exp(-0.5 * loss(r * r).rho);
  }
  return std::log(sum * step / 3);
}

struct Partition {
  double pixel = 0, rgbd = 0;
};

const std::array<Partition, kShapes.size()>& partitions() {
  static const auto table = [] {
    std::array<Partition, kShapes.size()> values;
    for (std::size_t i = 0; i < kShapes.size(); ++i)
      values[i] = {log_partition(kShapes[i], 2), log_partition(kShapes[i], 3)};
    return values;
  }();
  return table;
}

double median_scale2(std::span<const SquaredResidual> residuals) {
  std::vector<double> ratios;
  ratios.reserve(residuals.size());
  for (const SquaredResidual& r : residuals)
    ratios.push_back(r.chi2 / (r.dimension == 2 ? kMedianChi2Pixel : kMedianChi2Rgbd));
  return std::clamp(median(std::move(ratios)), kMinScale2, kMaxScale2);
}

constexpr double kNearly = 1e-9;

/// base^(shape / 2); most of the time goes here, and the shapes that are fitted need square roots only.
double power(double base, double shape) {
  if (shape == 1.0) return std::sqrt(base);
  if (shape == 0.5) return std::sqrt(std::sqrt(base));
  if (shape == 1.5) return std::sqrt(base) * std::sqrt(std::sqrt(base));
  return std::pow(base, shape / 2);
}

}  // namespace

LossValue GeneralLoss::operator()(double s) const {
  const double b = std::abs(shape - 2), x = s / scale2;
  if (b < kNearly) return {s, 1.0};
  if (std::abs(shape) < kNearly) return {scale2 * 2 * std::log1p(x / 2), 1.0 / (x / 2 + 1)};
  const double base = x / b + 1, raised = power(base, shape);
  return {scale2 * 2 * b / shape * (raised - 1), raised / base};
}

GeneralLoss fit_general_loss(std::span<const SquaredResidual> residuals, const GeneralLoss& fallback) {
  constexpr std::size_t kMinResiduals = 20;
  if (residuals.size() < kMinResiduals) return fallback;
  const double scale2 = median_scale2(residuals);
  GeneralLoss best = fallback;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kShapes.size(); ++i) {
    const GeneralLoss unit{kShapes[i], 1.0};
    double cost = 0;
    for (const SquaredResidual& r : residuals) {
      const double s = std::min(r.chi2 / scale2, kMaxNorm * kMaxNorm);
      cost += 0.5 * unit(s).rho + (r.dimension == 2 ? partitions()[i].pixel : partitions()[i].rgbd);
    }
    if (cost >= least) continue;
    least = cost;
    best = {kShapes[i], scale2};
  }
  return best;
}

}  // namespace rtd::vision
