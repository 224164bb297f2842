// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/general_loss.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace rtd::vision {
namespace {

std::vector<SquaredResidual> make_residuals(double sigma, double outlier_share) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, 1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<SquaredResidual> residuals;
  for (int i = 0; i < 2000; ++i) {
    const int dimension = i % 3 == 0 ? 2 : 3;
    const double scale = unit(random) < outlier_share ? 6 * sigma : sigma;
    double chi2 = 0;
    for (int k = 0; k < dimension; ++k) chi2 += std::pow(scale * normal(random), 2);
    residuals.push_back({chi2, dimension});
  }
  return residuals;
}

TEST(GeneralLoss, begins_as_the_square_and_slope_is_its_derivative) {
  for (const double shape : {2.0, 1.5, 1.0, 0.5, 0.0, -2.0}) {
    const GeneralLoss loss{shape, 0.6};
    EXPECT_NEAR(loss(1e-4).rho, 1e-4, 1e-7) << shape;
    for (const double s : {0.1, 2.0, 50.0}) {
      const double step = 1e-5 * s;
      EXPECT_NEAR(loss(s).slope, (loss(s + step).rho - loss(s - step).rho) / (2 * step), 1e-6) << shape;
    }
  }
}

TEST(GeneralLoss, finds_the_scale_of_clean_residuals_and_calls_them_gaussian) {
  for (const double sigma : {0.6, 1.0, 1.8}) {
    const GeneralLoss loss = fit_general_loss(make_residuals(sigma, 0), {});
    EXPECT_NEAR(loss.scale2, sigma * sigma, 0.1 * sigma * sigma);
    EXPECT_GE(loss.shape, 1.5);
  }
}

TEST(GeneralLoss, heavier_tails_give_smaller_shapes) {
  const double clean = fit_general_loss(make_residuals(1, 0), {}).shape;
  const double some = fit_general_loss(make_residuals(1, 0.1), {}).shape;
  const double many = fit_general_loss(make_residuals(1, 0.3), {}).shape;
  EXPECT_LT(some, clean);
  EXPECT_LE(many, some);
}

TEST(GeneralLoss, few_residuals_change_nothing) {
  const std::vector<SquaredResidual> few(5, SquaredResidual{3.0, 3});
  EXPECT_EQ(fit_general_loss(few, {0.5, 2.0}).shape, 0.5);
  EXPECT_EQ(fit_general_loss({}, {0.5, 2.0}).scale2, 2.0);
}

}  // namespace
}  // namespace rtd::vision
