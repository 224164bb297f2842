// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "common/camera/synthetic/faults.hpp"

namespace rtd::camera::synthetic {

/// The faults of a colour image at one instant. A pure function of seed and time; immutable.
class ColorFaults {
 public:
  ColorFaults(const SensorFaults& faults, cv::Size size_px, double fps, std::uint64_t seed);

  /// Vignetting, and light that changes before the exposure follows; in place. Before the sensor's noise.
  void expose(cv::Mat& color_bgr, double t_s) const;
  /// What JPEG leaves of an image; the image itself when it is not compressed.
  cv::Mat compressed(const cv::Mat& color_bgr) const;
  /// How much too bright the image is, in stops.
  double exposure_error_ev(double t_s) const;

 private:
  double light_ev(std::int64_t span) const;
  double change_s(std::int64_t span) const;

  SensorFaults faults_;
  double lag_s_;
  std::uint64_t seed_;
  cv::Mat falloff_;  ///< CV_32FC3, factor per pixel; empty without vignetting
};

}  // namespace rtd::camera::synthetic
