// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rtd::geometry {

/// Standard deviation of a structured-light depth camera, sigma(z) = offset + factor * z^2.
/// Khoshelham & Elberink 2012: random error of the Kinect grows with the square of depth, about 1.5 mm at 1 m.
struct DepthNoise {
  double offset_m = 0.001;
  double factor_per_m = 0.0015;
  double sigma_m(double depth_m) const { return offset_m + factor_per_m * depth_m * depth_m; }
};

}  // namespace rtd::geometry
