// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/inertial/motion_prior.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/camera/synthetic/camera_path.hpp"
#include "common/camera/synthetic/motion_sensors.hpp"

namespace rtd::slam {
namespace {

using camera::synthetic::CameraPath;
using camera::synthetic::SyntheticImu;
using camera::synthetic::SyntheticWheels;

constexpr double kFps = 30;
constexpr double kPose_m = 0.001, kPose_rad = 0.0005;  ///< noise of the measured poses

std::int64_t ns(double t_s) {
  return std::llround(t_s * 1e9);
}

/// A camera with IMU, or wheels, whose poses are measured with noise; its world is that of its first pose, tilted.
class Drive {
 public:
  Drive(camera::synthetic::CameraMotion motion, std::uint64_t seed, bool imu, bool wheels)
      : path_(motion, seed),
        imu_([this](double t_s) { return path_.T_world_camera(t_s); }, SyntheticImu::Options(), seed),
        wheels_([this](double t_s) { return path_.T_world_camera(t_s); }, seed),
        T_map_world_(path_.T_world_camera(0).inverse()),
        random_(static_cast<unsigned>(seed)) {
    config_.prior.imu = imu;
    config_.prior.wheels = wheels;
    config_.prior.T_base_camera = camera::synthetic::T_base_level_camera(path_.T_world_camera(0).translation().z());
    prior_.emplace(config_);
  }

  Eigen::Isometry3d truth(double t_s) const { return T_map_world_ * path_.T_world_camera(t_s); }
  MotionPrior& prior() { return *prior_; }
  const SyntheticImu& imu() const { return imu_; }
  double now_s() const { return static_cast<double>(frame_ - 1) / kFps; }
  Eigen::Vector3d up() const { return T_map_world_.linear() * Eigen::Vector3d::UnitZ(); }

  /// The next frame: what the prior expects there.
  std::optional<PredictedPose> expect() {
    const double t_s = static_cast<double>(frame_++) / kFps;
    for (; static_cast<double>(imu_index_) / 200 < t_s + 0.005; ++imu_index_) {
      const camera::ImuReading reading = imu_.reading(imu_index_);
      if (!muted_)
        prior_->add(inertial::ImuSample{reading.stamp_ns + kFirst_ns, reading.gyro_rad_s + more_bias_rad_s_,
                                        reading.accel_m_s2});
    }
    while (wheels_.next_s() < t_s + 0.02) {
      const camera::WheelReading reading = wheels_.next();
      prior_->add(WheelSample{reading.stamp_ns + kFirst_ns, reading.T_odom_base});
    }
    return prior_->advance(ns(t_s) + kFirst_ns);
  }
  void measure() { prior_->update(measured()); }
  PredictedPose measured() {
    std::normal_distribution<double> normal;
    const auto noise = [&] { return Eigen::Vector3d(normal(random_), normal(random_), normal(random_)); };
    PredictedPose pose;
    pose.T_world_camera = truth(now_s());
    pose.T_world_camera.translation() += kPose_m * noise();
    pose.T_world_camera.linear() = geometry::so3_exp(kPose_rad * noise()) * pose.T_world_camera.linear();
    pose.covariance.diagonal() << Eigen::Vector3d::Constant(kPose_m * kPose_m),
        Eigen::Vector3d::Constant(kPose_rad * kPose_rad);
    return pose;
  }
  void track(double duration_s) {
    for (int i = 0; i < static_cast<int>(duration_s * kFps); ++i) {
      expect();
      measure();
    }
  }
  void mute_imu(bool on) { muted_ = on; }
  void add_gyro_bias(const Eigen::Vector3d& bias_rad_s) { more_bias_rad_s_ += bias_rad_s; }

 private:
  static constexpr std::int64_t kFirst_ns = 1'000'000'000'000;
  CameraPath path_;
  SyntheticImu imu_;
  SyntheticWheels wheels_;
  Eigen::Isometry3d T_map_world_;
  std::mt19937 random_;
  SlamConfig config_;
  std::optional<MotionPrior> prior_;
  int frame_ = 0;
  std::int64_t imu_index_ = 0;
  bool muted_ = false;
  Eigen::Vector3d more_bias_rad_s_ = Eigen::Vector3d::Zero();
};

geometry::Vector6d error_of(const PredictedPose& pose, const Eigen::Isometry3d& T_truth) {
  geometry::Vector6d error;
  error << pose.T_world_camera.translation() - T_truth.translation(),
      geometry::so3_log(pose.T_world_camera.linear() * T_truth.linear().transpose());
  return error;
}

TEST(InertialFilter, finds_biases_and_gravity) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Drive drive(camera::synthetic::CameraMotion::kHandHeld, seed, true, false);
    drive.track(5);
    ASSERT_TRUE(drive.prior().filter());
    const InertialState& state = drive.prior().filter()->state();
    EXPECT_LT((state.bias.gyro_rad_s - drive.imu().gyro_bias_rad_s()).norm(), 0.0008) << "of 0.0087 rad/s";
    EXPECT_LT((state.bias.accel_m_s2 - drive.imu().accel_bias_m_s2()).norm(), 0.06) << "m/s2";
    EXPECT_LT(std::acos(-state.gravity_m_s2.normalized().dot(drive.up())), 0.008) << "rad";
    // Tilt and bias are separated slowly; what they do together is known at once.
    const Eigen::Matrix3d R = drive.truth(drive.now_s()).linear();
    const Eigen::Vector3d down = state.gravity_m_s2 + 9.80665 * drive.up();
    const Eigen::Vector3d bias = R * (drive.imu().accel_bias_m_s2() - state.bias.accel_m_s2);
    EXPECT_LT((down + bias).norm(), 0.02) << "m/s2";
  }
}

TEST(InertialFilter, with_time_distinguishes_tilt_from_bias) {
  Drive drive(camera::synthetic::CameraMotion::kRolling, 4, true, false);
  drive.track(30);
  const InertialState& state = drive.prior().filter()->state();
  EXPECT_LT((state.bias.accel_m_s2 - drive.imu().accel_bias_m_s2()).norm(), 0.01) << "m/s2";
  EXPECT_LT(std::acos(-state.gravity_m_s2.normalized().dot(drive.up())), 0.002) << "rad";
}

double position_sigma_m(const std::optional<PredictedPose>& pose) {
  return geometry::largest_sigma(pose->covariance.topLeftCorner<3, 3>());
}

TEST(InertialFilter, doubts_what_it_has_learnt_the_more_the_longer_no_pose_is_believed) {
  Drive drive(camera::synthetic::CameraMotion::kHandHeld, 1, true, false);
  drive.track(4);
  const auto at_once = drive.prior().doubted();
  EXPECT_NEAR(position_sigma_m(at_once), position_sigma_m(drive.prior().correct(drive.measured())), 1e-3) << "m";
  const ImuConfig imu;
  for (const double blind_s : {0.5, 1.0}) {
    std::optional<PredictedPose> expected;
    for (int i = 0; i < kFps / 2; ++i) expected = drive.expect();
    const double doubted_m = position_sigma_m(drive.prior().doubted());
    EXPECT_GT(doubted_m, imu.ready_m_s * blind_s) << "m: by the velocity alone";
    EXPECT_LT(doubted_m, 1.5 * imu.ready_m_s * blind_s) << "m: the biases come in later";
    EXPECT_LT(position_sigma_m(expected), 0.3 * doubted_m) << "m: what is claimed is by what was learnt";
  }
  drive.measure();
  EXPECT_LT(position_sigma_m(drive.prior().doubted()), 0.002) << "m: the pose is known again";
}

/// The gyroscope's bias is another than was learnt, and one second later a right pose is believed against it: how far
/// off half a second without a pose then ends, rad.
double turned_off_rad(bool doubts) {
  Drive drive(camera::synthetic::CameraMotion::kHandHeld, 2, true, false);
  drive.track(3);
  drive.add_gyro_bias({0, 0, 0.01});
  for (int i = 0; i < kFps; ++i) drive.expect();
  if (doubts) drive.prior().doubt();
  drive.measure();
  drive.track(0.3);
  std::optional<PredictedPose> expected;
  for (int i = 0; i < kFps / 2; ++i) expected = drive.expect();
  return error_of(*expected, drive.truth(drive.now_s())).tail<3>().norm();
}

TEST(InertialFilter, unlearns_what_a_believed_pose_contradicts) {
  EXPECT_GT(turned_off_rad(false), 0.006) << "rad";
  EXPECT_LT(turned_off_rad(true), 0.003) << "rad";
}

/// Mean NEES and largest position error of `seconds` without a measured pose, after two seconds with.
struct Blind {
  double nees = 0, largest_m = 0, sigma_m = 0;
};
Blind go_blind(Drive& drive, double seconds) {
  Blind result;
  const int frames = static_cast<int>(seconds * kFps);
  for (int i = 0; i < frames; ++i) {
    const auto pose = drive.expect();
    if (!pose) return {std::nan(""), std::nan(""), 0};
    const geometry::Vector6d error = error_of(*pose, drive.truth(drive.now_s()));
    result.nees += error.dot(pose->covariance.ldlt().solve(error)) / frames;
    result.largest_m = std::max(result.largest_m, error.head<3>().norm());
    result.sigma_m = std::sqrt(pose->covariance.topLeftCorner<3, 3>().trace());
  }
  return result;
}

/// Over many runs: the mean NEES, and the largest error of all.
Blind three_seconds_blind(camera::synthetic::CameraMotion motion, bool imu, bool wheels, double tracked_s) {
  constexpr int kRuns = 20;
  Blind all;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    Drive drive(motion, seed, imu, wheels);
    drive.track(tracked_s);
    const Blind blind = go_blind(drive, 3);
    EXPECT_FALSE(std::isnan(blind.nees)) << seed;
    all.nees += blind.nees / kRuns;
    all.largest_m = std::max(all.largest_m, blind.largest_m);
  }
  return all;
}

TEST(MotionPrior, bridges_three_seconds_by_imu_and_knows_how_well) {
  const Blind blind = three_seconds_blind(camera::synthetic::CameraMotion::kHandHeld, true, false, 2.5);
  EXPECT_LT(blind.largest_m, 0.15);
  EXPECT_GT(blind.nees, 3);
  EXPECT_LT(blind.nees, 9);
}

TEST(MotionPrior, bridges_three_seconds_by_wheels_and_knows_how_well) {
  const Blind blind = three_seconds_blind(camera::synthetic::CameraMotion::kDriving, false, true, 1);
  EXPECT_LT(blind.largest_m, 0.12);
  EXPECT_LT(blind.nees, 9);
}

TEST(MotionPrior, with_imu_and_wheels_is_better_than_with_either) {
  double imu_m = 0, wheels_m = 0, both_m = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto largest_m = [seed](bool imu, bool wheels) {
      Drive drive(camera::synthetic::CameraMotion::kDriving, seed, imu, wheels);
      drive.track(2);
      return go_blind(drive, 5).largest_m / 10;
    };
    imu_m += largest_m(true, false);
    wheels_m += largest_m(false, true);
    both_m += largest_m(true, true);
  }
  EXPECT_LT(both_m, imu_m);
  EXPECT_LT(both_m, wheels_m);
}

TEST(MotionPrior, of_a_camera_at_rest_stays_there) {
  Drive drive(camera::synthetic::CameraMotion::kFixed, 5, true, false);
  drive.track(2);
  const auto up = drive.prior().up_in_camera();
  ASSERT_TRUE(up);
  EXPECT_LT(std::acos(up->dot(drive.truth(0).linear().transpose() * drive.up())), 0.008)
      << "rad: 0.05 m/s2 of bias are 0.005 rad";
  const Blind blind = go_blind(drive, 3);
  EXPECT_LT(blind.largest_m, 0.1);
  EXPECT_LT(blind.nees, 18);
}

TEST(MotionPrior, expects_nothing_before_the_motion_is_known) {
  Drive drive(camera::synthetic::CameraMotion::kHandHeld, 6, true, false);
  EXPECT_FALSE(drive.expect());
  drive.measure();
  EXPECT_FALSE(drive.expect()) << "a velocity takes more than one pose";
}

TEST(MotionPrior, continues_after_a_second_without_imu) {
  Drive drive(camera::synthetic::CameraMotion::kHandHeld, 7, true, false);
  drive.track(3);
  drive.mute_imu(true);
  for (int i = 0; i < 3; ++i) drive.expect();
  EXPECT_TRUE(drive.prior().filter()->ready()) << "100 ms are bridged";
  for (int i = 0; i < 27; ++i) drive.expect();
  EXPECT_FALSE(drive.expect()) << "nothing is claimed";
  drive.mute_imu(false);
  drive.track(1);
  const Blind blind = go_blind(drive, 1);
  EXPECT_LT(blind.largest_m, 0.03) << "the biases are still known";
  EXPECT_LT(blind.nees, 18);
}

TEST(MotionPrior, goes_with_a_corrected_map) {
  Drive still(camera::synthetic::CameraMotion::kHandHeld, 8, true, false),
      moved(camera::synthetic::CameraMotion::kHandHeld, 8, true, false);
  still.track(3);
  moved.track(3);
  Eigen::Isometry3d T_new_old = Eigen::Isometry3d::Identity();
  T_new_old.translation() << 1, -2, 0.5;
  T_new_old.linear() = geometry::so3_exp({0.1, 0.3, -0.2});
  moved.prior().move(T_new_old);
  for (int i = 0; i < 30; ++i) {
    const auto a = still.expect(), b = moved.expect();
    ASSERT_TRUE(a && b);
    EXPECT_TRUE(b->T_world_camera.isApprox(T_new_old * a->T_world_camera, 1e-9));
    EXPECT_NEAR(b->covariance.trace(), a->covariance.trace(), 1e-9);
  }
}

TEST(MotionPrior, takes_velocity_and_gravity_along_to_another_place) {
  Drive drive(camera::synthetic::CameraMotion::kHandHeld, 9, true, false);
  drive.track(4);
  drive.expect();
  const Eigen::Vector3d up_before = *drive.prior().up_in_camera();
  Eigen::Isometry3d T_elsewhere = Eigen::Isometry3d::Identity();
  T_elsewhere.linear() = geometry::so3_exp({0, 1.5, 0});
  T_elsewhere.translation() << 5, 0, 3;
  PredictedPose found{T_elsewhere * drive.truth(drive.now_s()), geometry::Matrix6d::Identity() * 1e-6};
  drive.prior().relocate(found);
  EXPECT_LT((*drive.prior().up_in_camera() - up_before).norm(), 0.01);
  for (int i = 0; i < 15; ++i) {
    const auto pose = drive.expect();
    ASSERT_TRUE(pose);
    EXPECT_LT((pose->T_world_camera.translation() - (T_elsewhere * drive.truth(drive.now_s())).translation()).norm(),
              0.02);
  }
}

TEST(WheelStream, interpolates_and_refuses_pauses_jumps_and_broken_messages) {
  WheelStream stream({});
  const auto at = [](double t_s, double x_m) {
    WheelSample sample;
    sample.stamp_ns = ns(t_s);
    sample.T_odom_base.translation().x() = x_m;
    return sample;
  };
  for (int i = 0; i <= 50; ++i) stream.add(at(0.02 * i, 0.01 * i));
  const auto motion = stream.motion(ns(0.205), ns(0.715));
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->T_first_last.translation().x(), 0.5 * 0.51, 1e-9);
  EXPECT_NEAR(std::sqrt(motion->covariance(0, 0)), 0.03 * 0.255, 1e-3);
  EXPECT_NEAR(stream.motion(ns(0.5), ns(1.1))->T_first_last.translation().x(), 0.3, 1e-9) << "it continues";
  EXPECT_FALSE(stream.motion(ns(0.5), ns(1.3)));
  EXPECT_FALSE(stream.motion(ns(-0.5), ns(0.5)));
  WheelSample broken = at(1.02, std::numeric_limits<double>::infinity());
  stream.add(broken);
  stream.add(at(0.9, 1));
  EXPECT_EQ(stream.counters().invalid, 1U);
  EXPECT_EQ(stream.counters().out_of_order, 1U);
  stream.add(at(1.02, 5));  // it was begun again elsewhere
  EXPECT_EQ(stream.counters().jumps, 1U);
  stream.add(at(1.04, 5.01));
  EXPECT_FALSE(stream.motion(ns(0.5), ns(1.03)));
  EXPECT_TRUE(stream.motion(ns(1.02), ns(1.04)));
}

}  // namespace
}  // namespace rtd::slam
