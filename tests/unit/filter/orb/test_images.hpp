// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/imgproc.hpp>

#include "common/vision/rgbd_image.hpp"

namespace rtd::filter::test {

/// A camera like a Kinect's, without distortion.
inline geometry::CameraModel pinhole() {
  geometry::CameraModel::Parameters p;
  p.fx = p.fy = 525;
  p.cx = 319.5;
  p.cy = 239.5;
  p.width = 640;
  p.height = 480;
  return geometry::CameraModel(p);
}

/// Blobs of all sizes and grey values: corners everywhere, no two places alike. CV_8UC1.
inline cv::Mat textured_image(cv::Size size = {640, 480}, std::uint64_t seed = 7) {
  cv::RNG random(seed);
  cv::Mat image(size, CV_8UC1, cv::Scalar(128));
  for (int i = 0; i < size.area() / 150; ++i) {
    const cv::Point corner(random.uniform(0, size.width), random.uniform(0, size.height));
    const cv::Size side(random.uniform(3, 30), random.uniform(3, 30));
    cv::rectangle(image, cv::Rect(corner, side), cv::Scalar(random.uniform(0, 256)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, cv::Size(3, 3), 0.7);
  return image;
}

/// `grey` as the colour image, one depth everywhere.
inline vision::RgbdImage rgbd_image(const cv::Mat& grey, double depth_m = 2.0) {
  vision::RgbdImage image;
  cv::cvtColor(grey, image.color_bgr, cv::COLOR_GRAY2BGR);
  image.depth_scale_m = 1.0 / 5000;
  image.depth = cv::Mat(grey.size(), CV_16UC1, cv::Scalar(depth_m / image.depth_scale_m));
  image.camera = pinhole();
  return image;
}

}  // namespace rtd::filter::test
