// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/imu_of_truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "common/geometry/se3.hpp"
#include "common/msg/stamps.hpp"

namespace rtd::test_support {
namespace {

using geometry::Trajectory;
using geometry::Vector6d;

/// Way and turn from one true pose to the next, each on its own: m and rad.
Vector6d step(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  Vector6d step;
  step << to.translation() - from.translation(), geometry::so3_log(from.linear().transpose() * to.linear());
  return step;
}

/// Passes through the turns with the rate that the neighbours of each give it (cubic Hermite curves). The place follows
/// a cubic B-spline of 30 Hz, within a millimetre: noise of the truth would be an acceleration that jumps.
class SmoothPath {
 public:
  explicit SmoothPath(const Trajectory& truth) : truth_(truth) {
    if (truth_.size() < 2) throw std::invalid_argument("an IMU needs ground truth: the source has less than two poses");
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, truth_.size() - 1);
      speeds_.push_back(step(truth_[before].T_world_body, truth_[after].T_world_body) / gap_s(before, after));
    }
  }

  Eigen::Isometry3d operator()(double t_s) const {
    constexpr double kKnot_s = 1.0 / 30;
    const double knot = std::floor(t_s / kKnot_s), u = t_s / kKnot_s - knot, u2 = u * u, u3 = u2 * u;
    const std::array<double, 4> weights{(1 - u) * (1 - u) * (1 - u), 3 * u3 - 6 * u2 + 4, 1 + 3 * (u + u2 - u3), u3};
    Eigen::Isometry3d T_world_camera = through_truth(t_s);
    T_world_camera.translation().setZero();
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double t_knot_s = (knot + static_cast<double>(i) - 1) * kKnot_s;
      T_world_camera.translation() += weights[i] / 6 * through_truth(t_knot_s).translation();
    }
    return T_world_camera;
  }

 private:
  Eigen::Isometry3d through_truth(double t_s) const {
    const std::size_t i = segment_at(t_s);
    const double gap = gap_s(i, i + 1), u = std::clamp((t_s - gap_s(0, i)) / gap, 0.0, 1.0), u2 = u * u, u3 = u2 * u;
    const Eigen::Isometry3d& T = truth_[i].T_world_body;
    const Vector6d moved = (3 * u2 - 2 * u3) * step(T, truth_[i + 1].T_world_body) +
                           gap * ((u3 - 2 * u2 + u) * speeds_[i] + (u3 - u2) * speeds_[i + 1]);
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    T_world_camera.linear() = T.linear() * geometry::so3_exp(moved.tail<3>());
    T_world_camera.translation() = T.translation() + moved.head<3>();
    return T_world_camera;
  }
  double gap_s(std::size_t from, std::size_t to) const {
    return msg::minus_s(truth_[to].stamp_ns, truth_[from].stamp_ns);
  }
  std::size_t segment_at(double t_s) const {
    const auto after = std::upper_bound(truth_.begin() + 1, truth_.end() - 1, t_s, [this](double t, const auto& pose) {
      return t < msg::minus_s(pose.stamp_ns, truth_.front().stamp_ns);
    });
    return static_cast<std::size_t>(after - truth_.begin()) - 1;
  }

  Trajectory truth_;
  std::vector<Vector6d> speeds_;
};

std::int64_t first_stamp(const Trajectory& truth) {
  return truth.empty() ? 0 : truth.front().stamp_ns;
}

}  // namespace

ImuOfTruth::ImuOfTruth(const Trajectory& truth, const Options& options, std::uint64_t seed)
    : first_ns_(first_stamp(truth)), imu_(SmoothPath(truth), options, seed) {}

std::vector<camera::ImuReading> ImuOfTruth::until(std::int64_t stamp_ns) {
  constexpr double kBefore_s = 0.1;
  const double rate_hz = imu_.options().rate_hz, until_s = msg::minus_s(stamp_ns, first_ns_);
  if (next_ < 0) next_ = std::max<std::int64_t>(0, std::llround((until_s - kBefore_s) * rate_hz));
  std::vector<camera::ImuReading> readings;
  for (; static_cast<double>(next_) / rate_hz <= until_s + 1 / rate_hz; ++next_) {
    readings.push_back(imu_.reading(next_));
    readings.back().stamp_ns += first_ns_;
  }
  return readings;
}

}  // namespace rtd::test_support
