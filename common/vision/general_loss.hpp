// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace rtd::vision {

struct LossValue {
  double rho = 0, slope = 0;  ///< slope: d rho / d s
};

/// Barron's general robust loss in the squared norm s of a residual ("A General and Adaptive Robust Loss Function",
/// CVPR 2019, Eq. (13), in s and scaled so that it begins as s itself), docs/theory/tracking.md Eq. (8). `shape` 2 is
/// least squares, 1 pseudo-Huber, 0 Cauchy, -2 Geman-McClure.
struct GeneralLoss {
  double shape = 1.0;
  double scale2 = 1.0;  ///< variance of the residuals in units of the one that they were divided by

  LossValue operator()(double s) const;
};

/// One residual: its squared norm and how many numbers it has (2: pixel, 3: pixel and depth).
struct SquaredResidual {
  double chi2 = 0;
  int dimension = 3;
};

/// The loss under which these residuals are most likely: the scale from their median, the shape by the smallest
/// negative logarithm of the density that belongs to it (cut off at kMaxNorm, so that heavy tails have one).
/// docs/theory/tracking.md Eq. (9). With too few residuals: `fallback`.
GeneralLoss fit_general_loss(std::span<const SquaredResidual> residuals, const GeneralLoss& fallback);

}  // namespace rtd::vision
