// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace rtd::camera::synthetic {

/// Normal noise, mean 0, variance 1, whose correlation falls to 1/e at a distance. The same arguments give the same
/// field; immutable.
class NoiseField {
 public:
  /// `correlation_px`: 0 = white. `window_px`: size of the windows.
  NoiseField(double correlation_px, cv::Size window_px, std::uint64_t seed);

  /// The part of the field that belongs to an index, CV_32FC1; not to be written to.
  cv::Mat window(std::uint64_t index) const;
  /// The value that this share of the field is below; -inf for 0, +inf for 1.
  float quantile(double share) const;

 private:
  cv::Size window_px_;
  std::uint64_t seed_;
  cv::Mat field_;
  std::vector<float> sorted_;
};

}  // namespace rtd::camera::synthetic
