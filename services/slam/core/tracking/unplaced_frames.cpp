// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "common/msg/stamps.hpp"
#include "services/slam/core/tracking/tracker.hpp"

/// What the tracker does with a frame whose place in the map is not found.
namespace rtd::slam {

/// What the last frame saw may be enough for the motion since then, though not for a place in the map. Errors add up.
/// docs/theory/tracking.md, "Odometry".
bool Tracker::continue_without_map(TrackOutcome& outcome, const FramePtr& frame) {
  constexpr int kMinPoints = 20;
  constexpr std::size_t kYoungKeyframes = 20;  // such a map may not show yet what was seen a moment ago; an older one
                                               // is left as it is, and what fills most of the view is not followed
  const bool young = outcome.map->component_keyframes < kYoungKeyframes;
  if (!msg::has_pose(state_) || follows_prior(*frame) || (!young && hidden(*frame))) return false;
  LocalMapTracking tracking;
  tracking.guess = track_motion(*frame, last_, *outcome.map, predict(*frame), context());
  if (tracking.guess.points < kMinPoints || !continues_motion(*frame, tracking.guess.T_world_camera)) return false;
  follow(frame, *outcome.map, tracking);
  failing_since_ns_.reset();
  if (!young && !apart_since_ns_) apart_since_ns_ = frame->stamp_ns;
  outcome.apart = apart_since_ns_.has_value();
  outcome.tracked = last_;
  outcome.inliers = tracking.guess.points;
  outcome.state = state_ = msg::TrackingState::kOdometry;
  outcome.consistency = consistency_.value();
  covariance_ += config_.sensor.shared_error * tracking.guess.covariance;
  outcome.covariance = covariance_ + of_calibration(last_.T_world_camera);
  return true;
}

/// The old map is not recognised, but that has not lasted for so long that it has to grow here.
bool Tracker::waits_apart() const {
  const double after_s = config_.place.new_map_after_s;
  return apart_since_ns_ && (after_s == 0 || msg::minus_s(last_.frame->stamp_ns, *apart_since_ns_) < after_s ||
                             !can_initialize(*last_.frame));
}

/// Too little was found: predicts for a moment, or tracking is lost. A pose from few landmarks that agrees with the
/// prediction is better than the prediction alone.
void Tracker::reject(TrackOutcome& outcome, const FramePtr& frame_in_work, const PoseGuess& weak) {
  if (claim_prior(outcome, frame_in_work, weak)) return;
  const Frame& frame = *frame_in_work;
  if (auto claimed = hold(frame)) {
    const PredictedPose measured{weak.T_world_camera, weak.covariance};
    const bool usable = weak.success && weak.inliers >= config_.prediction.min_weak_inliers;
    if (usable && measured.covariance.trace() < claimed->covariance.trace() &&
        pose_distance2(*claimed, measured) < kMaxPoseDistance2) {
      claimed = measured;
    }
    outcome.tracked.T_world_camera = claimed->T_world_camera;
    outcome.covariance =
        config_.sensor.shared_error * claimed->covariance + map_covariance_ + of_calibration(claimed->T_world_camera);
    outcome.state = state_ = msg::TrackingState::kPredicted;
    return;
  }
  if (!failing_since_ns_) failing_since_ns_ = frame.stamp_ns;
  const double failing_s = msg::minus_s(frame.stamp_ns, *failing_since_ns_);
  motion_.reset();
  apart_since_ns_.reset();
  const bool recent = state_ != msg::TrackingState::kLost && failing_s <= config_.tracker.recently_lost_s;
  state_ = recent ? msg::TrackingState::kRecentlyLost : msg::TrackingState::kLost;
  relocalizer_.give_up();
  outcome.state = relocalizer_.located() ? state_ : msg::TrackingState::kRelocalizing;
}

std::string problem_of(const TrackOutcome& outcome, int needed) {
  using State = msg::TrackingState;
  const std::string state = msg::to_string(outcome.state), found = std::to_string(outcome.inliers);
  if (outcome.at_place()) return state + ": a place was recognised, the next frames have to agree";
  if (outcome.state == State::kOk) return "";
  if (outcome.contradicted)
    return state + ": within the last second, the IMU expected another pose than was found; either may be wrong";
  if (outcome.impossible) return state + ": a hand or a robot does not carry a camera so fast";
  if (outcome.settling) return state + ": the map has just begun, and nothing in view has been seen at rest for long";
  if (outcome.unwitnessed) return state + ": what was seen at rest before is not where this pose shows it";
  if (outcome.state == State::kDoubtful)
    return state + ": " + std::to_string(std::lround(100 * outcome.consistency)) +
           " % of the matched landmarks agree closely with the pose, which is known to " +
           std::to_string(std::lround(1e3 * outcome.sigma_m)) + " mm; it may follow something that moves";
  if (outcome.state == State::kOdometry)
    return state + ": the map is not recognised; " + found +
           " points of the last frame give the motion since then, and errors add up";
  const std::string begin = (outcome.state == State::kRecentlyLost ? "lost" : state) + ": " + found;
  if (outcome.inliers < needed) return begin + " of " + std::to_string(needed) + " landmarks that a pose needs";
  return begin + " landmarks agree with a pose that is not believed, because too few of the expected ones were found";
}

}  // namespace rtd::slam
