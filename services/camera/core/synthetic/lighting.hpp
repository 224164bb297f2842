// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace rtd::camera::synthetic {

/// Light that changes with time for the whole room: lamps that flicker, are dimmed and switched, and a camera whose
/// exposure follows. A pure function of seed and time.
class Lighting {
 public:
  /// `unrest`: 0 = constant light, 1 = full flicker.
  Lighting(double unrest, std::uint64_t seed);
  /// What becomes of a brightness in [0, 1]: gain * brightness^gamma.
  struct Curve {
    double gain = 1, gamma = 1;
  };
  Curve at(double t_s) const;
  /// Applies the curve to an 8-bit image in place.
  void apply(cv::Mat& color_bgr, double t_s) const;

 private:
  double unrest_, dim_rate_rad_s_, dim_phase_rad_, flicker_rate_rad_s_;
  std::uint64_t seed_;
};

}  // namespace rtd::camera::synthetic
