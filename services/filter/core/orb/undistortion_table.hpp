// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "common/geometry/camera_model.hpp"

namespace rtd::filter {

/// Undistorts pixels of one camera by bilinear interpolation in a table of exact solutions (error < 0.01 px for the TUM
/// cameras): a Newton solution per corner would cost a millisecond a frame. Rebuilt when the camera changes.
class UndistortionTable {
 public:
  /// Makes the table fit `camera`; cheap when it already does.
  void fit(const geometry::CameraModel& camera);
  cv::Point2f undistort(cv::Point2f raw_pixel) const;

 private:
  geometry::CameraModel::Parameters parameters_;
  bool identity_ = true;
  int columns_ = 0, rows_ = 0;
  std::vector<cv::Point2f> nodes_;  ///< undistorted pixel of every kStepPx-th raw pixel
};

}  // namespace rtd::filter
