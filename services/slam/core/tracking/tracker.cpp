// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/tracker.hpp"

#include <algorithm>
#include <utility>

#include "common/msg/stamps.hpp"
#include "common/vision/samples.hpp"
#include "services/slam/core/tracking/tracking_steps.hpp"
#include "services/slam/core/tracking/witnesses.hpp"

namespace rtd::slam {
namespace {

constexpr double kFirstPoseVariance = 1e-8;  ///< of the pose that makes the world

/// How far away what a frame sees is, m.
double median_distance(const LocalMap& map, const TrackedFrame& tracked) {
  std::vector<double> distances_m;
  distances_m.reserve(tracked.landmarks.size());
  for (const LandmarkId id : tracked.landmarks) {
    const LocalLandmark* landmark = id == kNoLandmark ? nullptr : map.find_landmark(id);
    if (landmark == nullptr) continue;
    distances_m.push_back((landmark->position - tracked.T_world_camera.translation()).norm());
  }
  return vision::median(std::move(distances_m));
}

}  // namespace

KeyframeId vote_reference(const LocalMap& map, const std::vector<LandmarkId>& landmarks) {
  std::vector<int> votes(map.keyframes.size(), 0);
  for (const LandmarkId id : landmarks) {
    const LocalLandmark* landmark = id == kNoLandmark ? nullptr : map.find_landmark(id);
    if (landmark == nullptr) continue;
    for (std::uint32_t i = 0; i < landmark->observers; ++i) ++votes[map.observers[landmark->first_observer + i]];
  }
  const auto most = std::max_element(votes.begin(), votes.end());
  return most == votes.end() || *most == 0 ? kNoKeyframe
                                           : map.keyframes[static_cast<std::size_t>(most - votes.begin())].id;
}

bool Tracker::can_initialize(const Frame& frame) const {
  const auto with_depth = std::count_if(frame.features.begin(), frame.features.end(),
                                        [](const msg::Feature& feature) { return feature.depth_m > 0; });
  return with_depth >= config_.tracker.min_initial_points;
}

TrackOutcome Tracker::initialize(FramePtr frame, LocalMapPtr map) {
  TrackOutcome outcome;
  outcome.state = state_ = msg::TrackingState::kOk;
  last_ = TrackedFrame{};
  last_.landmarks.assign(frame->features.size(), kNoLandmark);
  last_.frame = std::move(frame);
  last_.reference = map->keyframes.front().id;
  last_.T_world_camera = map->keyframes.front().T_world_camera;
  support_ = {};
  witnesses_.forget();
  probation_weight_ = 1;
  settling_since_ns_.reset();
  if (config_.witness.used && config_.witness.settle_s > 0) settling_since_ns_ = last_.frame->stamp_ns;
  outcome.settling = settling_since_ns_.has_value();
  if (outcome.settling) outcome.state = msg::TrackingState::kDoubtful;
  outcome.tracked = last_;
  outcome.inliers = static_cast<int>(map->landmarks.size());
  motion_.reset();
  rotation_covariance_.setZero();
  keyframe_ns_ = last_.frame->stamp_ns;
  failing_since_ns_.reset();
  apart_since_ns_.reset();
  relocalizer_.settle(map);
  consistency_.reset();
  if (prior_ != nullptr) {
    prior_->advance(last_.frame->stamp_ns);
    prior_->relocate({last_.T_world_camera, geometry::Matrix6d::Identity() * kFirstPoseVariance});
  }
  outcome.map = std::move(map);
  return outcome;
}

TrackOutcome Tracker::track(FramePtr frame, const LocalMapPtr& snapshot) {
  TrackOutcome outcome;
  outcome.map = relocalizer_.choose_map(snapshot, last_.reference);
  adopt(*outcome.map);
  expect(*frame);
  position_ = position_since_last(*frame);
  if (apart_since_ns_) outcome.T_world_expected = predict(*frame).T_world_camera;
  LocalMapTracking tracking;
  std::int64_t optimizer_ns = 0;
  for (const Attempt attempt : {Attempt::kLastFrame, Attempt::kKeyframe, Attempt::kAround, Attempt::kRecovery}) {
    const std::int64_t begin_ns = now_ns_();
    const PoseGuess guess = find_pose(attempt, *frame, *outcome.map);
    const std::int64_t matched_ns = now_ns_();
    outcome.stage_ms[msg::kStageMatch] += to_ms(matched_ns - begin_ns - guess.optimizer_ns);
    optimizer_ns += guess.optimizer_ns;
    if (!guess.success) continue;
    tracking = track_local_map(*frame, *outcome.map, guess, context());
    outcome.stage_ms[msg::kStageLocalMap] += to_ms(now_ns_() - matched_ns - tracking.guess.optimizer_ns);
    optimizer_ns += tracking.guess.optimizer_ns;
    if (!acceptable(tracking.guess) || !believable(*frame, guess, tracking)) continue;
    outcome.stage_ms[msg::kStagePose] = to_ms(optimizer_ns);
    outcome.inliers = tracking.guess.inliers;
    if (covered(*frame)) weigh_against_prior(tracking.guess);
    accept(outcome, std::move(frame), tracking);
    return outcome;
  }
  outcome.stage_ms[msg::kStagePose] = to_ms(optimizer_ns);
  outcome.inliers = tracking.guess.inliers;
  const std::int64_t failed_ns = now_ns_();
  position_.reset();
  rotation_.reset();  // of a camera that is elsewhere nothing is known
  auto found = follows_prior(*frame) ? std::nullopt : relocalizer_.search(frame, msg::has_pose(state_), context());
  outcome.stage_ms[msg::kStageRelocalize] = to_ms(now_ns_() - failed_ns);
  if (found) {
    enter_place(outcome, std::move(frame), std::move(*found));
  } else if (!continue_without_map(outcome, frame)) {
    reject(outcome, frame, tracking.guess);
  }
  return outcome;
}

void Tracker::forget_motion() {
  motion_.reset();
  witnesses_.forget();
  apart_since_ns_.reset();
  if (msg::has_pose(state_)) state_ = msg::TrackingState::kRecentlyLost;
}

void Tracker::await_relocalization() {
  motion_.reset();
  last_ = TrackedFrame{};
  apart_since_ns_.reset();
  settling_since_ns_.reset();  // it was there before those who walk now
  witnesses_.forget();
  state_ = msg::TrackingState::kLost;
  relocalizer_.await();
}

/// The map may have moved under the last frame, and the last frame may have become a keyframe with new landmarks.
void Tracker::adopt(const LocalMap& map) {
  const Eigen::Isometry3d T_before = last_.T_world_camera;
  adopt_pose(map);
  if (prior_ != nullptr && last_.frame != nullptr) prior_->move(last_.T_world_camera * T_before.inverse());
}

void Tracker::adopt_pose(const LocalMap& map) {
  for (const LocalKeyframe& keyframe : map.keyframes) {
    if (keyframe.frame != last_.frame) continue;
    last_.T_world_camera = keyframe.T_world_camera;
    last_.landmarks = keyframe.landmarks;
    last_.reference = keyframe.id;
    last_.T_reference_camera.setIdentity();
    return;
  }
  if (const LocalKeyframe* reference = map.find_keyframe(last_.reference)) {
    last_.T_world_camera = geometry::normalized(reference->T_world_camera * last_.T_reference_camera);
  }
}

/// Where to look: constant velocity, docs/theory/tracking.md Eq. (7); fading once frames have failed.
ExpectedPose Tracker::predict(const Frame& frame) const {
  if (follows_prior(frame)) return {expected_->T_world_camera, expected_radius_px(frame)};
  if (const auto held = state_ == msg::TrackingState::kPredicted ? hold(frame) : std::nullopt) {
    return {held->T_world_camera};
  }
  const double gap_s = since_last_s(frame);
  if (!motion_ || gap_s <= 0 || gap_s > kMaxPredictionGap_s) return {last_.T_world_camera};
  return {last_.T_world_camera * geometry::se3_exp(gap_s * motion_->velocity_per_s)};
}

/// The pose that may be claimed though nothing was measured; empty when too long ago.
std::optional<PredictedPose> Tracker::hold(const Frame& frame) const {
  if (last_.frame == nullptr) return std::nullopt;
  const double gap_s = since_last_s(frame);
  const bool recent = gap_s > 0 && gap_s <= config_.prediction.max_hold_s;
  if (!config_.techniques.prediction || !motion_ || !msg::has_pose(state_) || !recent) return std::nullopt;
  CameraMotion motion = *motion_;
  motion.T_world_camera = last_.T_world_camera;
  return predict_motion(motion, gap_s, config_.prediction);
}

PoseGuess Tracker::find_pose(Attempt attempt, const Frame& frame, const LocalMap& map) {
  const bool lost = state_ == msg::TrackingState::kLost, has_pose = msg::has_pose(state_);
  switch (attempt) {
    case Attempt::kLastFrame:
      return lost ? PoseGuess{} : track_last_frame(frame, last_, map, predict(frame), context());
    case Attempt::kKeyframe: {
      const LocalKeyframe* reference = map.find_keyframe(last_.reference);
      return lost || reference == nullptr ? PoseGuess{} : track_keyframe(frame, *reference, map, context());
    }
    case Attempt::kAround:
      return has_pose ? track_around(frame, last_, map, predict(frame), context()) : PoseGuess{};
    case Attempt::kRecovery:
      return has_pose || config_.techniques.place_recognition ? PoseGuess{} : recover(frame, map);
  }
  return {};
}

/// Without place recognition: tries a few keyframes of the window in each frame, going round.
PoseGuess Tracker::recover(const Frame& frame, const LocalMap& map) {
  const std::size_t tries =
      std::min(map.keyframes.size(), static_cast<std::size_t>(config_.tracker.recovery_keyframes));
  for (std::size_t i = 0; i < tries; ++i) {
    PoseGuess guess = track_keyframe(frame, map.keyframes[next_recovery_++ % map.keyframes.size()], map, context());
    if (guess.success) return guess;
  }
  return {};
}

bool Tracker::acceptable(const PoseGuess& guess) const {
  // After a loss a wrong place is the greater danger.
  const double strictness = msg::has_pose(state_) ? 1.0 : 1.5;
  return guess.success && guess.inliers >= strictness * config_.tracker.min_inliers;
}

/// The frame was tracked. After a recognised place some more must agree before a pose counts.
void Tracker::accept(TrackOutcome& outcome, FramePtr frame, const LocalMapTracking& tracking) {
  const double elapsed_s = since_last_s(*frame);
  apart_since_ns_.reset();
  outcome.impossible = moves_impossibly(*frame, tracking.guess.T_world_camera);
  consistency_.add(*frame, *outcome.map, tracking, elapsed_s);
  follow(std::move(frame), *outcome.map, tracking);
  outcome.tracked = last_;
  if (!relocalizer_.confirm()) {
    outcome.state = msg::TrackingState::kRelocalizing;
    return;
  }
  count(tracking);
  failing_since_ns_.reset();
  scene_m_ = median_distance(*outcome.map, last_);
  const bool had_pose = msg::has_pose(state_);
  state_ = msg::TrackingState::kOk;
  outcome.consistency = consistency_.value();
  outcome.rejected = tracking.rejected;
  const geometry::Matrix6d measured = config_.sensor.shared_error * tracking.guess.covariance;
  const geometry::Matrix6d local = measured + consistency_.covariance(scene_m_);
  outcome.sigma_m = geometry::largest_sigma(measured.topLeftCorner<3, 3>());
  outcome.settling = settles();
  outcome.unwitnessed = support_.doubtful;
  const bool unsupported = outcome.unwitnessed || outcome.settling || outcome.impossible;
  const bool doubtful = consistency_.doubts(outcome.sigma_m) || unsupported;
  outcome.state = doubtful ? msg::TrackingState::kDoubtful : state_;
  covariance_ = uncertainty_.in_world(local, last_.T_world_camera.translation(), last_.landmarks, *outcome.map);
  map_covariance_ = covariance_ - local;
  if (prior_ != nullptr && !weighed_) {  // it has the gyroscope itself
    const geometry::Matrix6d by_image = config_.sensor.shared_error * tracking.guess.image_covariance;
    report_to_prior(by_image + consistency_.covariance(scene_m_), had_pose);
  }
  outcome.covariance = covariance_ + of_calibration(last_.T_world_camera);
  outcome.contradicted = contradicted();
  if (outcome.contradicted) {
    outcome.state = msg::TrackingState::kDoubtful;
    outcome.covariance += contradiction_;
  }
}

/// Whether the map has just begun, and nothing in view has been seen at rest for long enough: all of it may move.
bool Tracker::settles() {
  if (!settling_since_ns_) return false;
  const double since_s = msg::minus_s(last_.frame->stamp_ns, *settling_since_ns_);
  if (support_.witnessed || since_s >= config_.witness.settle_s) settling_since_ns_.reset();
  return settling_since_ns_.has_value();
}

/// No pose yet: the next frames have to agree. But a place where the camera was a moment ago is no other place.
void Tracker::enter_place(TrackOutcome& outcome, FramePtr frame, Relocalizer::Found found) {
  const bool same_place = found.place->find_keyframe(last_.reference) != nullptr;
  if (same_place && continues_motion(*frame, found.tracking.guess.T_world_camera)) relocalizer_.accept();
  state_ = msg::TrackingState::kRecentlyLost;
  outcome.map = std::move(found.place);
  outcome.inliers = found.tracking.guess.inliers;
  motion_.reset();
  consistency_.reset();
  accept(outcome, std::move(frame), found.tracking);
}

/// The frame is the last tracked one from now on.
void Tracker::follow(FramePtr frame, const LocalMap& map, const LocalMapTracking& tracking) {
  const double gap_s = since_last_s(*frame);
  const bool in_time = (msg::has_pose(state_) || relocalizer_.entered()) && gap_s > 0 && gap_s <= kMaxPredictionGap_s;
  const Eigen::Isometry3d T_last_camera = last_.T_world_camera.inverse() * tracking.guess.T_world_camera;
  const bool continuous = in_time && (!motion_ || is_steady(*motion_, T_last_camera, gap_s));
  motion_.reset();
  if (continuous) {
    motion_ = CameraMotion{tracking.guess.T_world_camera, geometry::se3_log(T_last_camera) / gap_s, gap_s,
                           tracking.guess.covariance};
  }
  last_.frame = std::move(frame);
  last_.T_world_camera = tracking.guess.T_world_camera;
  last_.landmarks = tracking.guess.landmarks;
  if (const KeyframeId reference = vote_reference(map, last_.landmarks); reference != kNoKeyframe) {
    last_.reference = reference;
  }
  if (map.find_keyframe(last_.reference) == nullptr) last_.reference = map.keyframes.front().id;
  last_.T_reference_camera = map.find_keyframe(last_.reference)->T_world_camera.inverse() * last_.T_world_camera;
  inliers_ = tracking.guess.inliers;
  probation_weight_ = tracking.guess.probation_weight;
  support_ = witnesses_.judge(look_for_witnesses(*last_.frame, map, tracking), last_.frame->stamp_ns);
  rotation_covariance_ = tracking.guess.covariance.bottomRightCorner<3, 3>();
}

void Tracker::count(const LocalMapTracking& tracking) {
  const auto entry = [&](LandmarkId id) -> LandmarkStatistics& {
    LandmarkStatistics& statistics = statistics_[id];
    statistics.landmark = id;
    return statistics;
  };
  for (const LandmarkId id : tracking.visible) ++entry(id).visible;
  for (const LandmarkId id : tracking.guess.landmarks) {
    if (id != kNoLandmark) ++entry(id).found;
  }
}

KeyframeSituation Tracker::keyframe_situation(const LocalMap& map, bool mapper_idle) const {
  KeyframeSituation situation;
  situation.since_keyframe_s = msg::minus_s(last_.frame->stamp_ns, keyframe_ns_);
  situation.map_keyframes = static_cast<int>(map.component_keyframes);
  situation.inliers = inliers_;
  situation.mapper_idle = mapper_idle;
  situation.covered = weighed_ || waits_apart() || support_.contradicted;
  situation.mostly_unknown = support_.mostly_unknown;
  situation.settling = settling_since_ns_ && situation.since_keyframe_s >= config_.witness.after_s;
  situation.odometry = state_ == msg::TrackingState::kOdometry && !waits_apart();
  if (const LocalKeyframe* reference = map.find_keyframe(last_.reference)) {
    situation.reference_landmarks = map.confirmed_landmarks(*reference);
  }
  for (std::size_t i = 0; i < last_.frame->features.size(); ++i) {
    const double depth_m = last_.frame->features[i].depth_m;
    if (depth_m <= 0 || depth_m > config_.sensor.close_depth_m) continue;
    ++(last_.landmarks[i] != kNoLandmark ? situation.close_tracked : situation.close_untracked);
  }
  return situation;
}

KeyframeProposal Tracker::propose_keyframe() {
  KeyframeProposal proposal{last_.frame, last_.reference, last_.T_reference_camera, last_.landmarks, {}};
  if (apart_since_ns_) {  // what odometry gets wrong must not bend the old map: a loop joins the two
    std::ranges::fill(proposal.landmarks, kNoLandmark);
    apart_since_ns_.reset();
    consistency_.reset();
  }
  proposal.covariance = covariance_;
  proposal.carried = support_.carried;
  proposal.probation_weight = probation_weight_;
  for (const auto& [id, statistics] : statistics_) proposal.statistics.push_back(statistics);  // sums: order is free
  statistics_.clear();
  keyframe_ns_ = last_.frame->stamp_ns;
  return proposal;
}

bool wants_keyframe(const KeyframeSituation& s, const KeyframeConfig& config) {
  if (s.odometry) return true;
  constexpr double kYoungMapRatio = 0.4;  // with one keyframe only, its landmarks are not yet confirmed
  const double ratio = s.map_keyframes < 2 ? kYoungMapRatio : config.reference_ratio;
  const bool starving_of_close =
      s.close_tracked < config.min_close_tracked && s.close_untracked > config.min_close_untracked;
  const bool overdue = s.since_keyframe_s >= config.max_gap_s;
  const bool convenient = s.since_keyframe_s >= config.min_gap_s && s.mapper_idle;
  const bool weak = s.inliers < config.weak_ratio * s.reference_landmarks || starving_of_close;
  const bool new_view = s.inliers < ratio * s.reference_landmarks || starving_of_close || s.mostly_unknown;
  return (s.settling || ((overdue || convenient || weak) && new_view)) && s.inliers > config.min_inliers && !s.covered;
}

}  // namespace rtd::slam
