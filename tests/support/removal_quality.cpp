// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/removal_quality.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rtd::test_support {
namespace {

bool on(const cv::Mat& mask, const msg::Feature& feature) {
  if (mask.empty()) return false;
  const int u = std::clamp(static_cast<int>(std::lround(feature.u_raw_px)), 0, mask.cols - 1);
  const int v = std::clamp(static_cast<int>(std::lround(feature.v_raw_px)), 0, mask.rows - 1);
  return mask.at<std::uint8_t>(v, u) != 0;
}

}  // namespace

void RemovalQuality::count(const std::vector<msg::Feature>& features, const cv::Mat& moving) {
  cv::Mat grown;
  if (!moving.empty()) cv::dilate(moving, grown, cv::getStructuringElement(cv::MORPH_RECT, {7, 7}));
  for (const msg::Feature& feature : features) {
    if ((feature.flags & msg::kFeatureRemoved) != 0) {
      ++(on(grown, feature) ? removed_rightly : removed_wrongly);
    } else {
      ++(on(moving, feature) ? kept_wrongly : kept_rightly);
    }
  }
}

}  // namespace rtd::test_support
