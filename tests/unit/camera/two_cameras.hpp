// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "common/msg/ros.hpp"
#include "common/vision/rgbd_image.hpp"
#include "tests/support/box_scene.hpp"
#include "tests/unit/camera/image_bag.hpp"

namespace rtd::camera::test {

/// A colour and a depth camera side by side before a plate and a wall, as a driver publishes them.
struct TwoCameras {
  static constexpr int kWidth = 64, kHeight = 48;
  static constexpr double kUnit_m = 0.001;

  geometry::CameraModel color{{62, 61, 31, 24.5, {0.05, -0.02, 0.001, 0, 0}, kWidth, kHeight}};
  geometry::CameraModel depth{{50, 50, 40, 30, {}, 80, 60}};
  Eigen::Isometry3d T_color_depth = side_by_side();
  std::string color_frame = "camera_color_optical_frame", depth_frame = "camera_depth_optical_frame";

  static Eigen::Isometry3d side_by_side() {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = Eigen::Vector3d(-0.08, 0.03, 0.01);
    T.rotate(Eigen::AngleAxisd(0.05, Eigen::Vector3d(1, 2, 3).normalized()));
    return T;
  }
  static rtd::test::BoxScene scene() { return rtd::test::BoxScene::plate_before_wall(); }

  static msg::CameraInfo info(const geometry::CameraModel& camera) {
    const auto& p = camera.parameters();
    msg::CameraInfo info;
    info.width = static_cast<std::uint32_t>(p.width);
    info.height = static_cast<std::uint32_t>(p.height);
    info.distortion_model = "plumb_bob";
    info.d.assign(p.distortion.begin(), p.distortion.end());
    info.k = {p.fx, 0, p.cx, 0, p.fy, p.cy, 0, 0, 1};
    info.p = {p.fx, 0, p.cx, 0, 0, p.fy, p.cy, 0, 0, 0, 1, 0};
    return info;
  }
  msg::Image color_image(double stamp_s) const {
    msg::Image image = ImageBag::image(cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(1, 2, 3)), "bgr8", stamp_s);
    image.header.frame_id = color_frame;
    return image;
  }
  msg::Image depth_image(double stamp_s) const {
    msg::Image image = ImageBag::image(scene().depth(depth, Eigen::Isometry3d::Identity(), kUnit_m), "16UC1", stamp_s);
    image.header.frame_id = depth_frame;
    return image;
  }
  static msg::RosTransform transform(const Eigen::Isometry3d& T) {
    const Eigen::Quaterniond q(T.linear());
    const Eigen::Vector3d t = T.translation();
    return {{t.x(), t.y(), t.z()}, {q.x(), q.y(), q.z(), q.w()}};
  }
  /// Both cameras below a link; `slash` before frames, as tf of old.
  msg::TFMessage transforms(const std::string& slash = "") const {
    const Eigen::Isometry3d T_link_depth(Eigen::Translation3d(0.5, 0.6, 0.7) *
                                         Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, -1, 1).normalized()));
    msg::TransformStamped of_depth, of_color;
    of_depth.header.frame_id = of_color.header.frame_id = slash + "camera_link";
    of_depth.child_frame_id = slash + depth_frame;
    of_color.child_frame_id = slash + color_frame;
    of_depth.transform = transform(T_link_depth);
    of_color.transform = transform(T_link_depth * T_color_depth.inverse());
    return {{of_depth, of_color}};
  }

  /// The depth of the scene as the colour camera sees it: all that is not near an edge or hidden.
  void expect_registered(const vision::RgbdImage& image) const {
    ASSERT_EQ(image.depth.size(), cv::Size(kWidth, kHeight));
    const Eigen::Isometry3d T_depth_color = T_color_depth.inverse();
    int near = 0, far = 0, wrong = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double depth_m = image.depth.at<std::uint16_t>(y, x) * image.depth_scale_m;
        const double truth_m = scene().depth_m(color, T_depth_color, {x, y});
        if (std::abs(depth_m - truth_m) < 0.003) {
          ++(truth_m < 1.6 ? near : far);
        } else if (depth_m > 0) {
          ++wrong;
        }
      }
    }
    EXPECT_GT(near, 200);
    EXPECT_GT(far, 1500);
    EXPECT_LT(wrong, 60) << "at the edges of the plate";
  }
};

}  // namespace rtd::camera::test
