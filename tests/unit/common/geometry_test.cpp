// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <functional>
#include <opencv2/calib3d.hpp>
#include <random>
#include <utility>
#include <vector>

#include "common/geometry/camera_model.hpp"
#include "common/geometry/mover_trails.hpp"
#include "common/geometry/se3.hpp"
#include "common/msg/transform_eigen.hpp"

namespace rtd::geometry {
namespace {

using ::testing::Each;

CameraModel tum_fr1() {
  return CameraModel(
      {517.306408, 516.469215, 318.643040, 255.313989, {0.262383, -0.953104, -0.005358, 0.002628, 1.163314}, 640, 480});
}

TEST(CameraModel, undistort_inverts_distort_over_the_whole_image) {
  const CameraModel camera = tum_fr1();
  for (int v = 0; v <= 480; v += 40) {
    for (int u = 0; u <= 640; u += 40) {
      const Eigen::Vector2d raw(u, v);
      EXPECT_LT((camera.distort(camera.undistort(raw)) - raw).norm(), 1e-6) << u << " " << v;
    }
  }
}

TEST(CameraModel, distortion_moves_the_corner_by_pixels) {
  const CameraModel camera = tum_fr1();
  EXPECT_GT((camera.undistort({5, 5}) - Eigen::Vector2d(5, 5)).norm(), 2.0);
}

TEST(CameraModel, agrees_with_opencv_for_every_lens) {
  CameraModel::Parameters rational = tum_fr1().parameters();
  rational.distortion = {0.6, -2.7, 0.0004, -0.0002, 1.6, 0.48, -2.5, 1.5};  // of an Azure Kinect
  CameraModel::Parameters fisheye = tum_fr1().parameters();
  fisheye.fx = fisheye.fy = 280;
  fisheye.lens = Lens::kFisheye;
  fisheye.distortion = {-0.007, 0.04, -0.04, 0.007};
  for (const CameraModel::Parameters& p : {rational, fisheye}) {
    const CameraModel camera(p);
    const cv::Matx33d k(p.fx, 0, p.cx, 0, p.fy, p.cy, 0, 0, 1);
    const bool is_fisheye = p.lens == Lens::kFisheye;
    const std::vector<double> coefficients(p.distortion.begin(), p.distortion.begin() + (is_fisheye ? 4 : 8));
    for (const cv::Point3d& point : {cv::Point3d(0, 0, 1), cv::Point3d(0.4, -0.3, 1), cv::Point3d(-0.5, 0.2, 1)}) {
      std::vector<cv::Point2d> expected;
      const std::vector<cv::Point3d> points{point};
      if (is_fisheye) {
        cv::fisheye::projectPoints(points, expected, cv::Vec3d(), cv::Vec3d(), k, coefficients);
      } else {
        cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), k, coefficients, expected);
      }
      const Eigen::Vector2d pinhole = camera.project({point.x, point.y, point.z});
      const Eigen::Vector2d raw = camera.distort(pinhole);
      EXPECT_NEAR(raw.x(), expected[0].x, 1e-6);
      EXPECT_NEAR(raw.y(), expected[0].y, 1e-6);
      EXPECT_LT((camera.undistort(raw) - pinhole).norm(), 1e-4);
    }
  }
}

TEST(CameraModel, what_a_fisheye_lens_sees_behind_it_stays_finite) {
  CameraModel::Parameters p = tum_fr1().parameters();
  p.fx = p.fy = 150;
  p.lens = Lens::kFisheye;
  const Eigen::Vector2d corner = CameraModel(p).undistort({0, 0});  // 2.6 rad off the axis
  EXPECT_NEAR((corner - Eigen::Vector2d(p.cx, p.cy)).norm(), 150 * std::tan(CameraModel::kWidestView_rad), 1e-6);
}

TEST(CameraModel, no_distortion_bends_a_pixel_to_where_no_number_is) {
  for (const Lens lens : {Lens::kBrownConrady, Lens::kFisheye}) {
    for (const double k : {1e300, -1e300, 1e30, -1e5, 3.0}) {
      CameraModel::Parameters p = tum_fr1().parameters();
      p.lens = lens;
      p.distortion.fill(k);
      for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(0, 0), {639, 479}, {320, 5}}) {
        EXPECT_LE(CameraModel(p).undistort(pixel).cwiseAbs().maxCoeff(), 1e6) << k;
        EXPECT_LE(CameraModel(p).distort(pixel).cwiseAbs().maxCoeff(), 1e6) << k;
      }
    }
  }
}

TEST(CameraModel, unproject_inverts_project) {
  const CameraModel camera = tum_fr1();
  const Eigen::Vector3d p_camera(0.3, -0.2, 1.7);
  EXPECT_LT((camera.unproject(camera.project(p_camera), p_camera.z()) - p_camera).norm(), 1e-12);
}

TEST(CameraModel, contains_respects_the_margin) {
  const CameraModel camera = tum_fr1();
  EXPECT_TRUE(camera.contains({0, 0}));
  EXPECT_FALSE(camera.contains({0, 0}, 1));
  EXPECT_FALSE(camera.contains({640, 100}));
}

TEST(Se3, log_inverts_exp_for_random_twists) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (int i = 0; i < 200; ++i) {
    Vector6d twist;
    for (int k = 0; k < 6; ++k) twist[k] = uniform(random);
    EXPECT_LT((se3_log(se3_exp(twist)) - twist).norm(), 1e-9) << twist.transpose();
  }
}

TEST(Se3, small_angles_lose_no_precision) {
  Vector6d twist;
  twist << 1e-9, -2e-9, 3e-9, 1e-9, 2e-9, -1e-9;
  EXPECT_LT((se3_log(se3_exp(twist)) - twist).norm(), 1e-15);
}

TEST(Se3, exp_of_pure_rotation_turns_x_to_y) {
  Vector6d twist = Vector6d::Zero();
  twist[5] = M_PI / 2;
  EXPECT_LT((se3_exp(twist) * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

TEST(Se3, screw_motion_translates_along_its_arc) {
  Vector6d twist = Vector6d::Zero();
  twist[0] = M_PI / 2;  // quarter circle of radius 1 in the xy plane
  twist[5] = M_PI / 2;
  EXPECT_LT((se3_exp(twist).translation() - Eigen::Vector3d(1, 1, 0)).norm(), 1e-12);
}

TEST(Se3, skew_is_the_cross_product) {
  const Eigen::Vector3d a(1, 2, 3), b(-4, 5, 0.5);
  EXPECT_LT((skew(a) * b - a.cross(b)).norm(), 1e-15);
}

TEST(Se3, adjoint_carries_a_small_motion_to_the_other_side) {
  const Eigen::Isometry3d T = se3_exp((Vector6d() << 0.4, -1.2, 0.7, 0.3, 0.9, -0.5).finished());
  const Vector6d d = (Vector6d() << 0.2, 0.1, -0.3, -0.4, 0.2, 0.6).finished();
  EXPECT_TRUE((T * se3_exp(d) * T.inverse()).isApprox(se3_exp(adjoint(T) * d), 1e-12));
}

TEST(Se3, lever_arm_is_the_derivative_of_the_other_points_error) {
  const Eigen::Vector3d offset(0.3, -0.8, 1.4);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 6; ++i) {
    const Vector6d error = kStep * Vector6d::Unit(i);
    const Eigen::Matrix3d turn = so3_exp(error.tail<3>());
    const Eigen::Vector3d moved_m = error.head<3>() + turn * offset - offset;
    const Vector6d expected = lever_arm(offset) * error;
    EXPECT_TRUE(expected.head<3>().isApprox(moved_m, 1e-5)) << i;
    EXPECT_EQ(expected.tail<3>(), error.tail<3>());
  }
}

TEST(Transform, message_keeps_the_pose) {
  Vector6d twist;
  twist << 0.1, 0.2, -0.3, 0.4, -0.5, 0.6;
  const Eigen::Isometry3d T_a_b = se3_exp(twist);
  EXPECT_TRUE(msg::to_isometry(msg::to_message(T_a_b)).isApprox(T_a_b, 1e-12));
}

/// From `low` to `high` along x.
msg::Movers one(double stamp_s, double low, double high, double velocity_m_s, double sigma_m_s = 0.01) {
  msg::Movers frame;
  frame.stamp_ns = static_cast<std::int64_t>(stamp_s * 1e9);
  msg::Mover& mover = frame.movers.emplace_back();
  mover.id = 1;
  mover.center_m = {(low + high) / 2, 0, 2};
  mover.size_m = {high - low, 1, 1};
  mover.velocity_mps = {velocity_m_s, 0, 0};
  for (std::size_t place = 0; place < 36; place += 7) mover.covariance[place] = sigma_m_s * sigma_m_s;
  return frame;
}

/// What is said of an object at 10 Hz for two seconds; sides(time_s): where it begins and ends along x.
std::vector<bool> said(const std::function<std::pair<double, double>(double)>& sides, double velocity_m_s) {
  MoverTrails trails;
  std::vector<bool> rest;
  for (int i = 0; i <= 20; ++i) {
    const auto [low, high] = sides(i / 10.0);
    rest.push_back(trails.rest(one(i / 10.0, low, high, velocity_m_s))[0]);
  }
  return rest;
}

TEST(MoverTrails, an_object_that_goes_as_fast_as_it_is_said_to_moves_once_its_trail_is_long_enough) {
  const std::vector<bool> rest = said([](double t_s) { return std::pair(0.8 * t_s, 0.8 * t_s + 0.5); }, 0.8);
  EXPECT_TRUE(rest[7]);
  EXPECT_FALSE(rest[8]);
  EXPECT_FALSE(rest[20]);
}

TEST(MoverTrails, one_that_comes_into_view_grows_on_one_side_and_rests) {
  EXPECT_THAT(said([](double t_s) { return std::pair(0.0, 0.3 + t_s); }, 0.5), Each(true));
  EXPECT_THAT(said([](double) { return std::pair(0.0, 1.0); }, 1), Each(true)) << "with a velocity it does not follow";
}

TEST(MoverTrails, a_trail_with_a_gap_or_with_time_that_went_back_begins_again) {
  MoverTrails trails;
  const auto at = [&trails](double stamp_s) -> bool { return trails.rest(one(stamp_s, stamp_s, stamp_s + 1, 1))[0]; };
  EXPECT_EQ((std::array{at(0), at(1), at(1.2), at(9), at(0)}), (std::array{true, false, false, true, true}));
}

TEST(MoverTrails, a_velocity_that_may_be_noise_says_that_it_rests) {
  MoverTrails trails;
  const auto last = [&trails](double sigma_m_s) -> bool {
    trails = {};
    trails.rest(one(0, 0, 1, 0.5, sigma_m_s));
    return trails.rest(one(1, 0.5, 1.5, 0.5, sigma_m_s))[0];
  };
  EXPECT_FALSE(last(0.1));
  EXPECT_TRUE(last(0.25));
  EXPECT_TRUE(last(0)) << "without a covariance";
}

}  // namespace
}  // namespace rtd::geometry
