// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory_resource>
#include <optional>
#include <string>
#include <unordered_map>

#include "common/msg/tracking.hpp"
#include "services/slam/core/config/slam_config.hpp"
#include "services/slam/core/inertial/motion_prior.hpp"
#include "services/slam/core/mapping/mapper.hpp"
#include "services/slam/core/tracking/consistency.hpp"
#include "services/slam/core/tracking/pose_uncertainty.hpp"
#include "services/slam/core/tracking/relocalizer.hpp"
#include "services/slam/core/tracking/tracking_steps.hpp"
#include "services/slam/core/tracking/witnesses.hpp"

namespace rtd::slam {

/// What the decision looks at.
struct KeyframeSituation {
  double since_keyframe_s = 0;
  int map_keyframes = 0;
  int inliers = 0;              ///< landmarks tracked in this frame
  int reference_landmarks = 0;  ///< confirmed landmarks of the reference keyframe
  int close_tracked = 0;        ///< close features that are landmarks
  int close_untracked = 0;      ///< close features that could become some
  bool mapper_idle = true;
  bool odometry = false;        ///< the map is not recognised, and young or for long: it must grow here
  bool mostly_unknown = false;  ///< WitnessVerdict::mostly_unknown
  bool settling = false;        ///< a new map needs a second look at what it shows
  bool covered = false;         ///< something hides most of the view, and IMU or wheels help out
};

/// Whether to insert a keyframe if the mapper has room: ORB-SLAM2's rule for RGB-D, docs/theory/tracking.md Eq. (6).
bool wants_keyframe(const KeyframeSituation& situation, const KeyframeConfig& config);

/// What tracking found out about one frame.
struct TrackOutcome {
  LocalMapPtr map;  ///< the part of the map that the frame was compared with
  msg::TrackingState state = msg::TrackingState::kInitializing;
  TrackedFrame tracked;  ///< in state kPredicted the pose only; by IMU or wheels also frame and reference
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();
  int inliers = 0;
  double consistency = 1;  ///< Consistency::value()
  double sigma_m = 0;  ///< of the measured position along the worst axis, without what contradicts it; 0 without one
  bool impossible = false;            ///< no hand and no robot moves like that
  bool unwitnessed = false;           ///< WitnessVerdict::doubtful
  bool settling = false;              ///< nothing in the new map has been seen at rest for long enough
  bool contradicted = false;          ///< an IMU expected another pose less than a second ago
  std::vector<Association> rejected;  ///< landmarks that were recognised and contradict the measured pose
  /// Odometry continues next to the map, which is old and does not change. At the first frame after it: where odometry
  /// expects that frame.
  bool apart = false;
  std::optional<Eigen::Isometry3d> T_world_expected;
  std::array<float, msg::kSlamStages> stage_ms{};

  /// A place was recognised and is not confirmed yet.
  bool at_place() const { return state == msg::TrackingState::kRelocalizing && tracked.frame != nullptr; }
};

/// One line for people about a frame that is not tracked as it should be; empty where it is. `needed`: landmarks.
std::string problem_of(const TrackOutcome& outcome, int needed);

/// Follows the camera through the map: motion model, else reference keyframe; then local map; when that fails, the
/// places that look alike. Owns no map, sees it in snapshots only. docs/theory/tracking.md, place_recognition.md. Not
/// thread-safe.
class Tracker {
 public:
  /// Without `places` a lost camera is found only around its last pose. `prior` receives every measured pose and must
  /// outlive the tracker; null: neither IMU nor wheels.
  Tracker(const SlamConfig& config, Clock now_ns, PlaceSource places = {}, MotionPrior* prior = nullptr)
      : config_(config),
        now_ns_(std::move(now_ns)),
        prior_(prior),
        relocalizer_(config, std::move(places)),
        consistency_(config.consistency),
        witnesses_(config.witness) {}

  /// Whether a first keyframe can be made of this frame.
  bool can_initialize(const Frame& frame) const;
  /// The frame is the first keyframe of a map, at the origin of its world; `map` is what that map consists of.
  TrackOutcome initialize(FramePtr frame, LocalMapPtr map);
  /// Tracks one frame. A failure leaves the last tracked frame as it was.
  TrackOutcome track(FramePtr frame, const LocalMapPtr& snapshot);
  /// The map may have moved under the last frame: takes its pose from its reference keyframe, as track() does first.
  void adopt(const LocalMap& map);
  /// Of the last tracked frame.
  const Eigen::Isometry3d& T_world_camera() const { return last_.T_world_camera; }
  /// The source started again: no motion can be assumed between the last frame and the next.
  void forget_motion();
  /// Where the map began, if not where the configuration says.
  void set_first_pose(const Eigen::Isometry3d& T_world_camera) { config_.first_pose = T_world_camera; }
  /// Between the last two tracked frames; empty when they were too far apart.
  const std::optional<CameraMotion>& motion() const { return motion_; }

  /// The map was there before the first frame: no pose until a frame is found in it.
  void await_relocalization();
  /// False until then.
  bool located() const { return relocalizer_.located(); }

  /// Whether the frame just tracked should become a keyframe, and what the mapper then needs.
  KeyframeSituation keyframe_situation(const LocalMap& map, bool mapper_idle) const;
  KeyframeProposal propose_keyframe();

 private:
  TrackingContext context() const { return {config_, now_ns_, rotation_, position_}; }
  /// What an error of the calibration adds by the way from where the map began. docs/theory/tracking.md Eq. (15).
  geometry::Matrix6d of_calibration(const Eigen::Isometry3d& T_world_camera) const {
    return calibration_covariance(config_.first_pose.inverse() * T_world_camera, scene_m_,
                                  config_.sensor.calibration_error);
  }
  void adopt_pose(const LocalMap& map);
  ExpectedPose predict(const Frame& frame) const;
  void expect(const Frame& frame);
  std::optional<vision::PositionPrior> position_since_last(const Frame& frame) const;
  std::optional<vision::RotationPrior> rotation_since_last(std::int64_t now_ns) const;
  double expected_radius_px(const Frame& frame) const;
  double since_last_s(const Frame& frame) const;
  bool follows_prior(const Frame& frame) const;
  bool is_expected(const Frame& frame, const Eigen::Isometry3d& T_world_camera) const;
  bool hidden(const Frame& frame) const;
  bool covered(const Frame& frame) const { return follows_prior(frame) && hidden(frame); }
  void weigh_against_prior(PoseGuess& guess);
  double contradiction2() const { return config_.prior.contradiction * config_.prior.contradiction; }
  bool turns_as_measured(const Frame& frame, const PoseGuess& guess) const;
  bool contradicts_prior(const Frame& frame, const LocalMapTracking& tracking) const;
  bool contradicted() const;
  void report_to_prior(const geometry::Matrix6d& covariance, bool had_pose);
  /// Ways to a first guess of the pose, in the order in which they are tried.
  enum class Attempt { kLastFrame, kKeyframe, kAround, kRecovery };
  PoseGuess find_pose(Attempt attempt, const Frame& frame, const LocalMap& map);
  PoseGuess recover(const Frame& frame, const LocalMap& map);
  bool acceptable(const PoseGuess& guess) const;
  bool believable(const Frame& frame, const PoseGuess& start, const LocalMapTracking& tracking) const;
  bool continues_motion(const Frame& frame, const Eigen::Isometry3d& T_world_camera) const;
  bool settles();
  bool moves_impossibly(const Frame& frame, const Eigen::Isometry3d& T_world_camera) const;
  void enter_place(TrackOutcome& outcome, FramePtr frame, Relocalizer::Found found);
  void follow(FramePtr frame, const LocalMap& map, const LocalMapTracking& tracking);
  void accept(TrackOutcome& outcome, FramePtr frame, const LocalMapTracking& tracking);
  bool continue_without_map(TrackOutcome& outcome, const FramePtr& frame);
  bool waits_apart() const;
  void reject(TrackOutcome& outcome, const FramePtr& frame, const PoseGuess& weak);
  bool claim_prior(TrackOutcome& outcome, const FramePtr& frame, const PoseGuess& weak);
  std::optional<PredictedPose> hold(const Frame& frame) const;
  void count(const LocalMapTracking& tracking);

  SlamConfig config_;
  Clock now_ns_;
  MotionPrior* prior_;
  std::optional<PredictedPose> expected_;          ///< of the frame in work, by the prior
  std::optional<vision::RotationPrior> rotation_;  ///< of the frame in work, by the gyroscope from last_ on
  std::optional<vision::PositionPrior> position_;  ///< of the frame in work
  Eigen::Matrix3d rotation_covariance_ = Eigen::Matrix3d::Zero();  ///< of last_ against the map, in the world
  std::optional<std::int64_t> contradicted_ns_;  ///< stamp of the last believed pose that the prior contradicted
  geometry::Matrix6d contradiction_ = geometry::Matrix6d::Zero();  ///< square of how far off it was expected
  bool weighed_ = false;       ///< the pose of the frame in work is also by the prior
  double usual_features_ = 0;  ///< static ones of the last seconds
  Relocalizer relocalizer_;
  msg::TrackingState state_ = msg::TrackingState::kInitializing;
  TrackedFrame last_;
  Consistency consistency_;
  MapUncertainty uncertainty_;
  geometry::Matrix6d covariance_ = geometry::Matrix6d::Zero();      ///< of last_, in the world
  geometry::Matrix6d map_covariance_ = geometry::Matrix6d::Zero();  ///< the map's part of it
  double scene_m_ = 0;                                              ///< how far away what last_ sees is
  std::optional<CameraMotion> motion_;  ///< at the last tracked frame, whose pose the map may have moved since
  int inliers_ = 0;
  WitnessJudge witnesses_;
  WitnessVerdict support_;                         ///< of last_
  double probation_weight_ = 1;                    ///< PoseGuess::probation_weight of last_
  std::optional<std::int64_t> settling_since_ns_;  ///< stamp of a map's first frame, while nothing in it is a witness
  std::int64_t keyframe_ns_ = 0;                   ///< stamp of the last frame that was proposed
  std::optional<std::int64_t> apart_since_ns_;     ///< stamp of the first frame of TrackOutcome::apart, while it is
  std::optional<std::int64_t> failing_since_ns_;   ///< stamp of the first frame without a pose, while there is none
  std::size_t next_recovery_ = 0;
  std::pmr::unsynchronized_pool_resource statistics_memory_;  ///< used again from keyframe to keyframe
  StatisticsById statistics_{&statistics_memory_};
};

/// The keyframe of the window that sees most of these landmarks; kNoKeyframe when none does.
KeyframeId vote_reference(const LocalMap& map, const std::vector<LandmarkId>& landmarks);

}  // namespace rtd::slam
