// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "services/slam/core/tracking/tracker.hpp"

/// What the tracker does with the pose that IMU or wheels expect. docs/theory/inertial.md, "Tracking".
namespace rtd::slam {

void Tracker::expect(const Frame& frame) {
  constexpr double kForgotten = 0.003;  // of the usual number in each frame: ten seconds
  usual_features_ = std::max((1 - kForgotten) * usual_features_, static_cast<double>(frame.features.size()));
  weighed_ = false;
  if (prior_ == nullptr) return;
  expected_ = prior_->advance(frame.stamp_ns);
  rotation_ = config_.prior.known_rotation ? rotation_since_last(frame.stamp_ns) : std::nullopt;
}

/// Where the last frame has a pose. Its error and that of the gyroscope add up. docs/theory/inertial.md Eq. (15).
std::optional<vision::RotationPrior> Tracker::rotation_since_last(std::int64_t now_ns) const {
  constexpr double kMost_s = 1.0;
  if (last_.frame == nullptr || !msg::has_pose(state_)) return std::nullopt;
  const auto turn = prior_->turn_since(last_.frame->stamp_ns);
  if (!turn || inertial::seconds_between(last_.frame->stamp_ns, now_ns) > kMost_s) return std::nullopt;
  const Eigen::Matrix3d R_world_camera = last_.T_world_camera.linear() * turn->R_earlier_later;
  return vision::RotationPrior{R_world_camera,
                               turn->covariance + R_world_camera.transpose() * rotation_covariance_ * R_world_camera};
}

/// Whether something hides most of what there was to see a moment ago.
bool Tracker::hidden(const Frame& frame) const {
  return static_cast<double>(frame.features.size()) < config_.prior.covered_share * usual_features_;
}

/// Few landmarks, on one side of the view, leave a pose free in some directions: there the prior holds it.
void Tracker::weigh_against_prior(PoseGuess& guess) {
  const double factor = config_.prior.covered_factor * config_.sensor.shared_error;
  const PredictedPose fused = prior_->correct({guess.T_world_camera, factor * guess.covariance}).value_or(*expected_);
  guess.T_world_camera = fused.T_world_camera;
  guess.covariance = fused.covariance / config_.sensor.shared_error;  // what the factor is applied to
  weighed_ = true;
}

/// Whether IMU or wheels still know the pose well enough to claim it. docs/theory/inertial.md, "Predicted poses".
bool Tracker::follows_prior(const Frame& frame) const {
  if (!expected_ || !config_.techniques.prediction || !msg::has_pose(state_)) return false;
  const double gap_s = inertial::seconds_between(last_.frame->stamp_ns, frame.stamp_ns);
  const Eigen::Matrix3d position = expected_->covariance.topLeftCorner<3, 3>();
  return gap_s > 0 && gap_s <= config_.prior.max_hold_s &&
         geometry::largest_sigma(position) <= config_.prior.max_sigma_m;
}

/// Three standard deviations of where a landmark at the usual distance is seen, and what a feature itself is off.
double Tracker::expected_radius_px(const Frame& frame) const {
  constexpr double kSigmas = 3, kOfFeature_px = 5, kMost_rad = 0.2;
  const geometry::Vector6d variances = expected_->covariance.diagonal();
  const double scene_m = std::max(scene_m_, 0.5);
  const double seen_rad =
      std::sqrt(variances.tail<3>().maxCoeff() + variances.head<3>().maxCoeff() / (scene_m * scene_m));
  return kOfFeature_px + frame.camera.fx * std::min(kSigmas * seen_rad, kMost_rad);
}

/// Whether a view that is not covered turns as the gyroscope says. What contradicts such a pose is the accelerometer: a
/// filter that began next to something that moves has learnt a wrong velocity.
bool Tracker::turns_as_measured(const Frame& frame, const PoseGuess& guess) const {
  constexpr double kMaxTurn2 = 11.3;  // 99 % of chi2 with 3 degrees of freedom
  if (!rotation_ || covered(frame)) return false;
  const Eigen::Vector3d off_rad =
      geometry::so3_log(rotation_->R_world_camera.transpose() * guess.T_world_camera.linear());
  return off_rad.dot(rotation_->covariance.ldlt().solve(off_rad)) < kMaxTurn2;
}

/// A person who fills the view takes many matches along, but not the IMU: only a pose that most of the expected
/// landmarks support is believed against it.
bool Tracker::contradicts_prior(const Frame& frame, const LocalMapTracking& tracking) const {
  if (!follows_prior(frame) || turns_as_measured(frame, tracking.guess)) return false;
  const PredictedPose measured{tracking.guess.T_world_camera, config_.sensor.shared_error * tracking.guess.covariance};
  const bool is_covered = covered(frame);
  const double distance2 = pose_distance2(is_covered ? *expected_ : *prior_->doubted(), measured);
  const double most2 = is_covered ? kMaxPoseDistance2 : contradiction2();
  return distance2 > most2 && !agrees_widely(frame, tracking, config_.prior.weak_support);
}

/// The prior learns from a measured pose; `covariance` is relative to the map.
void Tracker::report_to_prior(const geometry::Matrix6d& covariance, bool had_pose) {
  constexpr double kDoubtful_m = 0.02, kDoubtful_rad = 0.02;  // 2.5 of them are the limits of docs/integrity.md
  const PredictedPose measured{last_.T_world_camera, config_.prior.visual_factor * covariance};
  const bool found_again = !had_pose && (!expected_ || pose_distance2(*expected_, measured) > kMaxPoseDistance2);
  if (found_again) {
    prior_->relocate(measured);
    return;
  }
  if (expected_ && pose_distance2(*expected_, {last_.T_world_camera, covariance}) > contradiction2()) {
    prior_->doubt();
    const geometry::Vector6d off = geometry::pose_difference(expected_->T_world_camera, last_.T_world_camera);
    if (off.head<3>().norm() > kDoubtful_m || off.tail<3>().norm() > kDoubtful_rad) {
      contradicted_ns_ = last_.frame->stamp_ns;
      contradiction_ = off * off.transpose();
    }
  }
  prior_->update(measured);
}

/// Whether an IMU contradicted a pose that was believed, within the span that docs/integrity.md judges: either of both
/// may be wrong.
bool Tracker::contradicted() const {
  constexpr double kSpan_s = 1;
  if (!config_.prior.imu || !contradicted_ns_) return false;
  const double since_s = inertial::seconds_between(*contradicted_ns_, last_.frame->stamp_ns);
  return since_s >= 0 && since_s <= kSpan_s;
}

/// The pose is where IMU or wheels expect it. A pose from few landmarks that agrees with them corrects them.
bool Tracker::claim_prior(TrackOutcome& outcome, const FramePtr& frame, const PoseGuess& weak) {
  if (!follows_prior(*frame)) return false;
  PredictedPose claimed = *expected_;
  const PredictedPose measured{weak.T_world_camera,
                               config_.prior.covered_factor * config_.sensor.shared_error * weak.covariance};
  const bool usable = weak.success && weak.inliers >= config_.prediction.min_weak_inliers;
  if (usable && pose_distance2(claimed, measured) < kMaxPoseDistance2)
    claimed = prior_->correct(measured).value_or(claimed);
  prior_->remember(frame->seq);
  outcome.tracked.frame = frame;
  outcome.tracked.T_world_camera = claimed.T_world_camera;
  outcome.tracked.reference = last_.reference;
  const Eigen::Isometry3d T_world_reference = last_.T_world_camera * last_.T_reference_camera.inverse();
  outcome.tracked.T_reference_camera = T_world_reference.inverse() * claimed.T_world_camera;
  outcome.covariance = claimed.covariance + map_covariance_ + of_calibration(claimed.T_world_camera);
  outcome.state = state_ = msg::TrackingState::kPredicted;
  return true;
}

}  // namespace rtd::slam
