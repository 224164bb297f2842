// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/vision/depth_registration.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <stdexcept>

#include "tests/support/box_scene.hpp"

namespace rtd::vision {
namespace {

using geometry::CameraModel;
using test::BoxScene;

constexpr double kUnit_m = 0.0001;  // its rounding is not what is tested

Eigen::Isometry3d mounted(const Eigen::Vector3d& translation_m, const Eigen::Vector3d& rotation_rad) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = translation_m;
  if (rotation_rad.norm() > 0) T.linear() = Eigen::AngleAxisd(rotation_rad.norm(), rotation_rad.normalized()).matrix();
  return T;
}

struct Rig {
  const char* name;
  CameraModel color, depth;
  Eigen::Isometry3d T_color_depth;
  double magnification;  ///< depth px -> colour px
  friend void PrintTo(const Rig& rig, std::ostream* out) { *out << rig.name; }

  cv::Mat registered(const cv::Mat& image) const {
    return DepthRegistration(color, depth, T_color_depth, kUnit_m)(image);
  }
};

Rig same_size() {
  return {"same_size", CameraModel({520, 522, 318, 241, {0.1, -0.2, 0.002, -0.001, 0.05}, 640, 480}),
          CameraModel({520, 520, 322, 238, {-0.05, 0.02, 0.001, 0.001, 0}, 640, 480}),
          mounted({-0.025, 0.002, 0.003}, {0.01, -0.015, 0.008}), 1};
}
Rig twice_as_large() {
  return {"twice_as_large", CameraModel({600, 600, 320, 240, {}, 640, 480}),
          CameraModel({300, 300, 160, 120, {}, 320, 240}), mounted({0.05, 0, 0}, {0, 0.01, 0.02}), 2};
}
Rig smaller() {
  return {"smaller", CameraModel({260, 260, 160, 118, {-0.3, 0.1, 0, 0, 0}, 317, 240}),
          CameraModel({500, 500, 318, 241, {}, 637, 479}), mounted({0.015, -0.01, 0}, {0, 0, 0}), 0.52};
}
Rig quarter_turn() {
  return {"quarter_turn", CameraModel({400, 400, 240, 320, {}, 480, 640}),
          CameraModel({400, 400, 320, 240, {}, 640, 480}), mounted({0.02, 0.03, 0}, {0, 0, std::numbers::pi / 2}), 1};
}
Rig upside_down() {
  return {"upside_down", CameraModel({400, 400, 320, 240, {}, 640, 480}),
          CameraModel({400, 400, 320, 240, {}, 640, 480}), mounted({0.02, 0, 0}, {0, 0, std::numbers::pi}), 1};
}

Rig rational_and_fisheye() {
  return {"rational_and_fisheye",
          CameraModel({500, 500, 320, 240, {0.6, -0.7, 0.0004, -0.0002, 0.2, 0.48, -0.5, 0.1}, 640, 480}),
          CameraModel({500, 500, 322, 238, {-0.007, 0.04, -0.04, 0.007}, 640, 480, rtd::geometry::Lens::kFisheye}),
          mounted({-0.02, 0, 0}, {0, 0.01, 0}), 1};
}
Rig fisheye_and_pinhole() {
  return {"fisheye_and_pinhole",
          CameraModel({400, 400, 320, 240, {-0.007, 0.04, -0.04, 0.007}, 640, 480, rtd::geometry::Lens::kFisheye}),
          CameraModel({400, 400, 320, 240, {}, 640, 480}), mounted({0.02, 0, 0}, {0, 0, 0.01}), 1};
}

class Rigs : public testing::TestWithParam<Rig> {};
INSTANTIATE_TEST_SUITE_P(All, Rigs,
                         testing::Values(same_size(), twice_as_large(), smaller(), quarter_turn(), upside_down(),
                                         rational_and_fisheye(), fisheye_and_pinhole()),
                         [](const auto& rig) { return rig.param.name; });

/// Pixels of the colour image that see a point which the depth camera sees too, and how far the registered depth is
/// off.
struct Comparison {
  int pixels = 0, without_depth = 0;
  double largest_m = 0;
};

template <class Wanted>
Comparison compare(const Rig& rig, const BoxScene& scene, const cv::Mat& registered, const Wanted& wanted) {
  const Eigen::Isometry3d T_depth_color = rig.T_color_depth.inverse();
  Comparison result;
  for (int y = 0; y < registered.rows; ++y) {
    for (int x = 0; x < registered.cols; ++x) {
      const double truth_m = scene.depth_m(rig.color, T_depth_color, {x, y});
      const Eigen::Vector3d p_color = rig.color.unproject(rig.color.undistort(Eigen::Vector2d(x, y)), truth_m);
      const Eigen::Vector3d p_depth = T_depth_color * p_color;
      const Eigen::Vector2d seen = rig.depth.distort(rig.depth.project(p_depth));
      if (truth_m == 0 || !rig.depth.contains(seen, 2)) continue;
      const bool hidden = scene.depth_m(rig.depth, Eigen::Isometry3d::Identity(), seen) < p_depth.z() - 0.005;
      if (hidden || !wanted(Eigen::Vector2d(x, y), truth_m)) continue;
      const double depth_m = registered.at<std::uint16_t>(y, x) * kUnit_m;
      ++result.pixels;
      if (depth_m == 0) ++result.without_depth;
      if (depth_m > 0) result.largest_m = std::max(result.largest_m, std::abs(depth_m - truth_m));
    }
  }
  return result;
}

TEST_P(Rigs, a_slanted_wall_is_where_the_colour_camera_sees_it_without_cracks) {
  const Rig& rig = GetParam();
  const BoxScene scene({{Eigen::Vector3d(0.5, -0.3, 1), 2.0}});
  const cv::Mat registered = rig.registered(scene.depth(rig.depth, Eigen::Isometry3d::Identity(), kUnit_m));
  const Comparison all = compare(rig, scene, registered, [](const auto&, double) { return true; });
  EXPECT_GT(all.pixels, registered.rows * registered.cols * 6 / 10);
  EXPECT_EQ(all.without_depth, 0);
  EXPECT_LT(all.largest_m, 0.001);
  RecordProperty("largest_mm", std::to_string(all.largest_m * 1e3));
}

/// Whether the scene has this depth at a pixel or at most so far from it.
bool has_depth_near(const Rig& rig, const BoxScene& scene, const Eigen::Vector2d& pixel, double reach_px,
                    double depth_m) {
  const Eigen::Isometry3d T_depth_color = rig.T_color_depth.inverse();
  for (const double dy : {0.0, -1.0, -0.5, 0.5, 1.0}) {
    for (const double dx : {0.0, -1.0, -0.5, 0.5, 1.0}) {
      const Eigen::Vector2d at = pixel + reach_px * Eigen::Vector2d(dx, dy);
      if (std::abs(scene.depth_m(rig.color, T_depth_color, at) - depth_m) < 0.001) return true;
    }
  }
  return false;
}

TEST_P(Rigs, an_edge_is_at_most_half_a_pixel_off_and_not_smeared) {
  const Rig& rig = GetParam();
  const BoxScene scene = BoxScene::plate_before_wall();
  const cv::Mat registered = rig.registered(scene.depth(rig.depth, Eigen::Isometry3d::Identity(), kUnit_m));
  // Half a pixel of the coarser image, and what the quads overlap.
  const double reach_px = 0.5 * std::max(1.0, rig.magnification) + 0.05;
  int painted = 0, wrong = 0;
  for (int y = 0; y < registered.rows; ++y) {
    for (int x = 0; x < registered.cols; ++x) {
      const double depth_m = registered.at<std::uint16_t>(y, x) * kUnit_m;
      if (depth_m == 0) continue;
      ++painted;
      if (!has_depth_near(rig, scene, {x, y}, reach_px, depth_m)) ++wrong;
    }
  }
  EXPECT_GT(painted, registered.rows * registered.cols / 2);
  EXPECT_EQ(wrong, 0);
}

TEST_P(Rigs, what_is_hidden_by_something_nearer_does_not_show_through) {
  const Rig& rig = GetParam();
  const BoxScene scene = BoxScene::plate_before_wall();
  const cv::Mat registered = rig.registered(scene.depth(rig.depth, Eigen::Isometry3d::Identity(), kUnit_m));
  const Eigen::Isometry3d T_depth_color = rig.T_color_depth.inverse();
  const double border_px = 2 * std::max(1.0, rig.magnification);
  const auto inside_plate = [&](const Eigen::Vector2d& pixel, double truth_m) {
    if (truth_m > 1.5) return false;
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      const Eigen::Vector2d beside = pixel + border_px * Eigen::Vector2d(dx, dy);
      if (scene.depth_m(rig.color, T_depth_color, beside) > 1.5) return false;
    }
    return true;
  };
  const Comparison plate = compare(rig, scene, registered, inside_plate);
  EXPECT_GT(plate.pixels, 3000);
  EXPECT_EQ(plate.without_depth, 0);
  EXPECT_LT(plate.largest_m, 0.001);
}

TEST_P(Rigs, noise_leaves_no_cracks) {
  const Rig& rig = GetParam();
  const BoxScene scene({{Eigen::Vector3d(0.5, -0.3, 1), 2.0}});
  cv::Mat depth = scene.depth(rig.depth, Eigen::Isometry3d::Identity(), kUnit_m);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (auto pixel = depth.begin<std::uint16_t>(); pixel != depth.end<std::uint16_t>(); ++pixel) {
    const double depth_m = *pixel * kUnit_m, noise_m = 0.0015 * depth_m * depth_m * normal(random);
    *pixel = static_cast<std::uint16_t>(std::min((depth_m + noise_m) / kUnit_m, 65534.0));
  }
  const Comparison all = compare(rig, scene, rig.registered(depth), [](const auto&, double) { return true; });
  EXPECT_LE(all.without_depth, all.pixels / 20000);
}

TEST(DepthRegistration, the_same_camera_at_the_same_place_changes_nothing) {
  const CameraModel camera({500, 500, 20, 15, {0.1, -0.1, 0.001, 0, 0}, 41, 31});
  cv::Mat depth(31, 41, CV_16UC1);
  cv::randu(depth, 500, 60000);
  depth.at<std::uint16_t>(5, 6) = 0, depth.at<std::uint16_t>(7, 8) = 65535;
  const cv::Mat registered = DepthRegistration(camera, camera, Eigen::Isometry3d::Identity(), 0.001)(depth);
  depth.at<std::uint16_t>(7, 8) = 0;
  EXPECT_EQ(cv::norm(registered, depth, cv::NORM_INF), 0);
}

TEST(DepthRegistration, an_image_without_depth_stays_without_depth) {
  const Rig rig = same_size();
  EXPECT_EQ(cv::countNonZero(rig.registered(cv::Mat::zeros(480, 640, CV_16UC1))), 0);
  EXPECT_EQ(cv::countNonZero(rig.registered(cv::Mat(480, 640, CV_16UC1, cv::Scalar(65535)))), 0);
}

TEST(DepthRegistration, what_the_colour_camera_cannot_see_does_not_come_back_through_its_lens_model) {
  // r (1 - 0.6 r^2) turns back at r = 0.75; the image ends at 0.5, the depth camera sees up to 1.6.
  const CameraModel narrow({320, 320, 160, 120, {-0.6, 0, 0, 0, 0}, 320, 240});
  const CameraModel wide({200, 200, 320, 240, {}, 640, 480});
  cv::Mat depth = cv::Mat::zeros(480, 640, CV_16UC1);
  depth(cv::Rect(0, 0, 120, 480)) = 20000;
  depth(cv::Rect(520, 0, 120, 480)) = 20000;
  const cv::Mat registered = DepthRegistration(narrow, wide, Eigen::Isometry3d::Identity(), kUnit_m)(depth);
  EXPECT_EQ(cv::countNonZero(registered), 0);
}

TEST(DepthRegistration, points_behind_the_colour_camera_are_not_seen) {
  const CameraModel camera({500, 500, 320, 240, {}, 640, 480});
  const DepthRegistration registration(camera, camera, mounted({0, 0, -1}, {0, 0, 0}), kUnit_m);
  EXPECT_EQ(cv::countNonZero(registration(cv::Mat(480, 640, CV_16UC1, cv::Scalar(9000)))), 0);
  EXPECT_GT(cv::countNonZero(registration(cv::Mat(480, 640, CV_16UC1, cv::Scalar(20000)))), 300'000);
}

TEST(DepthRegistration, refuses_what_cannot_be_registered) {
  const CameraModel camera({500, 500, 20, 15, {}, 41, 31});
  const auto identity = Eigen::Isometry3d::Identity();
  const DepthRegistration registration(camera, camera, identity, 0.001);
  EXPECT_THROW(registration(cv::Mat(30, 41, CV_16UC1)), std::invalid_argument);
  EXPECT_THROW(registration(cv::Mat(31, 41, CV_32FC1)), std::invalid_argument);
  EXPECT_THROW(DepthRegistration(CameraModel(), camera, identity, 0.001), std::invalid_argument);
  EXPECT_THROW(DepthRegistration(camera, camera, identity, 0), std::invalid_argument);
  EXPECT_THROW(DepthRegistration(camera, camera, mounted({NAN, 0, 0}, {0, 0, 0}), 0.001), std::invalid_argument);
}

}  // namespace
}  // namespace rtd::vision
