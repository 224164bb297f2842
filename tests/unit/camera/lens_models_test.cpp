// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/lens_models.hpp"

#include <gmock/gmock.h>

#include "common/camera/calibration.hpp"
#include "common/camera/frame_source.hpp"
#include "common/camera/recording/ros_images.hpp"

namespace rtd::camera {
namespace {

using Eigen::Vector2d;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::array<double, 5> kD455 = {-0.0553, 0.0663, -0.0006, 0.0003, -0.0215};

/// librealsense's rsutil.h, written down again.
Vector2d librealsense(const Vector2d& n, bool modified) {
  const auto& [k1, k2, p1, p2, k3] = kD455;
  const double r2 = n.squaredNorm(), f = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  const double xf = n.x() * f, yf = n.y() * f, x = modified ? xf : n.x(), y = modified ? yf : n.y();
  return {xf + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), yf + 2 * p2 * x * y + p1 * (r2 + 2 * y * y)};
}

msg::CameraInfo info_of(const std::string& model, const std::vector<double>& coefficients) {
  msg::CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.k = {385, 0, 321, 0, 386, 243, 0, 0, 1};
  info.distortion_model = model;
  info.d = coefficients;
  return info;
}

geometry::CameraModel camera_of(const std::string& model, const std::vector<double>& coefficients) {
  return to_camera_model(info_of(model, coefficients), "/color/image_raw", "topic /info");
}

/// How far the ideal pixel is from that of `undistorted`, at the worst of many pixels of the camera's own image.
double worst_px(const geometry::CameraModel& camera, const std::function<Vector2d(const Vector2d&)>& undistorted) {
  const auto& p = camera.parameters();
  double worst = 0;
  for (double u = 0; u <= p.width; u += 20) {
    for (double v = 0; v <= p.height; v += 20) {
      const Vector2d n = undistorted({(u - p.cx) / p.fx, (v - p.cy) / p.fy});
      worst = std::max(worst, (camera.undistort({u, v}) - Vector2d(n.x() * p.fx + p.cx, n.y() * p.fy + p.cy)).norm());
    }
  }
  return worst;
}

TEST(LensModels, inverse_brown_conrady_leads_from_the_image_to_the_ideal_one) {
  const auto truth = [](const Vector2d& n) { return librealsense(n, false); };
  for (const char* name : {"Inverse Brown Conrady", "inverse_brown_conrady"}) {
    EXPECT_LT(worst_px(camera_of(name, {kD455.begin(), kD455.end()}), truth), 0.1) << name;
  }
  EXPECT_GT(worst_px(camera_of("plumb_bob", {kD455.begin(), kD455.end()}), truth), 5) << "the other way round";
}

TEST(LensModels, modified_brown_conrady_moves_the_point_before_its_tangential_part) {
  const geometry::CameraModel camera = camera_of("Modified Brown Conrady", {kD455.begin(), kD455.end()});
  const auto& p = camera.parameters();
  for (const Vector2d& n : {Vector2d(0, 0), Vector2d(0.6, -0.5), Vector2d(-0.7, 0.3)}) {
    const Vector2d raw = librealsense(n, true), ideal(n.x() * p.fx + p.cx, n.y() * p.fy + p.cy);
    EXPECT_LT((camera.distort(ideal) - Vector2d(raw.x() * p.fx + p.cx, raw.y() * p.fy + p.cy)).norm(), 0.1);
  }
}

TEST(LensModels, kannala_brandt_is_the_equidistant_model_and_none_bends_nothing) {
  for (const char* name : {"Kannala Brandt4", "KANNALA_BRANDT4", "equidistant", "fisheye"}) {
    const auto camera = camera_of(name, {0.1, -0.02, 0.003, 0.0004, 0}).parameters();
    EXPECT_EQ(camera.lens, geometry::Lens::kFisheye) << name;
    EXPECT_EQ(camera.distortion, (std::array<double, 8>{0.1, -0.02, 0.003, 0.0004})) << name;
  }
  EXPECT_FALSE(camera_of("None", {0.1, 0.2, 0, 0, 0}).distorted());
  EXPECT_EQ(camera_of("Brown Conrady", {0.1, 0.2, 0, 0, 0.3}).parameters().distortion[4], 0.3);
  EXPECT_FALSE(camera_of("whatever", {0, 0, 0, 0, 0}).distorted());
}

TEST(LensModels, every_other_name_is_refused_by_it) {
  for (const char* name : {"Ftheta", "omnidirectional", "thin_prism_fisheye"}) {
    EXPECT_THAT(
        [&] {
          camera_of(name, {0.9, 0, 0, 0, 0});
        },
        ThrowsMessage<SourceError>(AllOf(HasSubstr(name), HasSubstr("topic /info"), HasSubstr("known:"))));
  }
  EXPECT_THAT(
      [] {
        camera_of("Inverse Brown Conrady", {-1.5, 0, 0, 0, 0});
      },
      ThrowsMessage<SourceError>(HasSubstr("bends the image too much")));
}

TEST(LensModels, calibration_files_know_the_same_names) {
  const Calibration inverse = parse_calibration(
      R"({"width": 640, "height": 480, "fx": 385, "fy": 386, "ppx": 321, "ppy": 243, "model": "Inverse Brown Conrady",
          "coeffs": [-0.0553, 0.0663, -0.0006, 0.0003, -0.0215]})",
      "rs.json");
  EXPECT_LT(worst_px(inverse.camera, [](const Vector2d& n) { return librealsense(n, false); }), 0.1);
  const Calibration nerf = parse_calibration(
      R"({"camera_model": "OPENCV_FISHEYE", "fl_x": 300, "fl_y": 300, "cx": 320, "cy": 240, "w": 640, "h": 480,
          "k1": 0.1, "k2": 0.2, "k3": 0.3, "k4": 0.4})",
      "transforms.json");
  EXPECT_EQ(nerf.camera.parameters().lens, geometry::Lens::kFisheye);
  EXPECT_THAT(
      [] {
        parse_calibration(
            "image_width: 640\nimage_height: 480\ncamera_matrix:\n  data: [385, 0, 321, 0, 386, "
            "243, 0, 0, 1]\ndistortion_model: ftheta\ndistortion_coefficients:\n  data: [1]\n",
            "c.yaml");
      },
      ThrowsMessage<SourceError>(AllOf(HasSubstr("c.yaml"), HasSubstr("'ftheta'"))));
  EXPECT_EQ(parse_calibration(R"({"model": "iPhone14,3", "fx": 1, "fy": 1, "cx": 320, "cy": 240, "w": 640, "h": 480})",
                              "phone.json")
                .camera.parameters()
                .width,
            640);
}

}  // namespace
}  // namespace rtd::camera
