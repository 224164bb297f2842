// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/msg/features.hpp"
#include "common/vision/rgbd_image.hpp"
#include "services/filter/core/config/filter_config.hpp"

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

/// Grey images of one frame, each smaller by the scale factor. Small images are doubled first, because a corner is
/// found to a fraction of a pixel of its level only. Buffers are reused from frame to frame.
class ImagePyramid {
 public:
  ImagePyramid(int levels, double scale_factor)
      : scale_factor_(scale_factor), images_(static_cast<std::size_t>(levels)) {}

  /// `image`: CV_8UC3 (BGR) or CV_8UC1. Levels between 0 and `first_level` are left as they are.
  void build(const cv::Mat& image, int first_level = 0);

  int levels() const { return static_cast<int>(images_.size()); }
  const cv::Mat& image(int level) const { return images_[static_cast<std::size_t>(level)]; }
  /// Pixel of a level -> pixel of the image. Pixel centres map to pixel centres, so no octave is biased against
  /// another.
  cv::Point2f to_base(cv::Point2f pixel, int level) const;

 private:
  double scale_factor_;
  cv::Size size_;  ///< of the image
  std::vector<cv::Mat> images_;
};

/// ORB features of an RGB-D image: multi-scale FAST corners, spread over the image, with orientation, descriptor,
/// undistorted position and depth. docs/theory/orb.md. The same image gives the same features, in the same order (by
/// octave). Keeps buffers: one instance per thread.
class OrbExtractor {
 public:
  explicit OrbExtractor(const OrbConfig& config);

  /// About config.feature_count features (never more than msg::kMaxFeatures), each with static_probability 1, no flags,
  /// no object.
  std::vector<msg::Feature> extract(const vision::RgbdImage& image) { return extract(image, config_.feature_count); }
  /// The same with another number of wanted features, and without those of the levels below `first_level`: the
  /// finest levels cost most of the time, and their features are the most precise.
  std::vector<msg::Feature> extract(const vision::RgbdImage& image, int feature_count, int first_level = 0);

  const OrbConfig& config() const { return config_; }

 private:
  void append_level(const vision::RgbdImage& image, int level, int wanted, std::vector<msg::Feature>& features);

  OrbConfig config_;
  ImagePyramid pyramid_;
  UndistortionTable undistortion_;
  cv::Mat smoothed_;
};

/// Depth (m) at a pixel of the camera's own image: the nearest pixel; 0 when not measured or outside the range of the
/// config.
float depth_at(const vision::RgbdImage& image, float u_raw_px, float v_raw_px, const OrbConfig& config);

}  // namespace rtd::filter
