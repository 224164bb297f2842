// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

namespace rtd::slam {

class Vocabulary;

/// Every number of the SLAM core with its default; bound to keys `slam.*` in services/slam/config.cpp.

/// One switch for each technique beyond ORB-SLAM2's tracking and mapping, so that its worth can be measured.
struct Techniques {
  bool landmark_belief = false;  ///< landmarks bear a static probability over time; off: the mean of their observations
  bool adaptive_kernel = true;   ///< robust loss fitted to the residuals; off: Huber with a fixed threshold
  bool rolling_shutter = true;   ///< the readout time of the image is estimated and undone; off: all rows at once
  bool prediction = true;        ///< a short, marked prediction when nothing static is in view; off: lost at once
  bool place_recognition = true;  ///< places are known again by their words; off: only around the last pose
  bool loop_closing = true;       ///< known places correct the map; off: drift stays
};

/// The camera and its features, as SLAM weighs them.
struct SensorConfig {
  double disparity_px_m = 40.0;  ///< weight of depth against pixels, vision::RgbdProjection::disparity_px_m
  double close_depth_m = 4.0;    ///< nearer depths make landmarks at once, farther ones wait for a second view
  double shared_error = 3.0;     ///< features share errors of image and depth: factor on the covariance of the pose
  double readout_s = 0;          ///< of the image, first row to last, if it is known; 0: estimated while tracking
  double max_depth_m = 8.0;      ///< depth beyond is not used at all
};

struct TrackerConfig {
  int min_initial_points = 100;    ///< features with depth that the first keyframe needs
  double motion_radius_px = 15.0;  ///< search radius of the motion model at the finest octave
  double local_radius_px = 3.0;    ///< factor on 2.5 / 4 px when the local map is searched
  int min_motion_matches = 20;     ///< matches with the last frame; fewer: track against the reference keyframe
  int min_inliers = 30;            ///< landmarks that a pose needs to count as tracked
  int recently_lost_frames = 30;   ///< failed frames before "recently lost" becomes "lost"
  int recovery_keyframes = 3;      ///< keyframes tried in each frame while lost
};

/// What is said of the pose while nothing static is in view: docs/theory/tracking.md, "Prediction".
struct PredictionConfig {
  double max_hold_s = 0.5;           ///< after the last measured pose; then tracking is lost
  double velocity_decay_s = 0.5;     ///< the velocity fades with this time constant
  double acceleration_m_s2 = 1.0;    ///< standard deviation of what a hand does meanwhile
  double acceleration_rad_s2 = 3.0;  ///< the same for its rotation
  int min_weak_inliers = 12;         ///< landmarks of a pose too weak to count as tracked but better than none
};

/// What a frame says of a landmark's static probability, as log odds: docs/theory/tracking.md, "Belief".
struct BeliefConfig {
  double found = 0.4;            ///< found where it should be by a feature that is surely static; -0.4: surely dynamic
  double rejected = 0.5;         ///< against it: matched, but does not fit a pose that its neighbours fit
  double removed = 1.5;          ///< against it: the filter removed what looks like it
  double seen_through = 0.5;     ///< against it: not found, and the depth measured there lies behind it
  double max_log_odds = 4.0;     ///< bound: how long the past counts
  double min_probability = 0.1;  ///< below: it leaves the map
};

/// When a frame becomes a keyframe: docs/theory/tracking.md, "Keyframes".
struct KeyframeConfig {
  int max_gap_frames = 30;       ///< a keyframe at least so often
  int min_gap_frames = 0;        ///< and not more often
  double reference_ratio = 0.9;  ///< tracked / reference landmarks below which the view is new
  double weak_ratio = 0.25;      ///< below: insert although the mapper is busy
  int min_close_tracked = 100;   ///< fewer close landmarks tracked ...
  int min_close_untracked = 70;  ///< ... and more close features that could become landmarks: insert
  int min_inliers = 15;          ///< fewer: a keyframe would rather harm
};

struct MapperConfig {
  int neighbours = 10;            ///< covisible keyframes for triangulation and fusion
  double min_found_ratio = 0.25;  ///< landmarks found less often than they should be seen are removed
  double redundant_ratio = 0.9;   ///< keyframes whose landmarks are seen by three others are removed
  int ba_keyframes = 12;          ///< optimised keyframes of a local bundle adjustment
  int ba_fixed_keyframes = 20;    ///< keyframes that hold the gauge
  int ba_iterations_robust = 5;   ///< with Huber, before outliers are taken out
  int ba_iterations = 0;          ///< after that, inliers only and no loss; 0 = no second stage
  double correction_m = 0.002;    ///< a keyframe that moved more is announced again
  double correction_rad = 0.001;
};

/// How places are recognised: docs/theory/place_recognition.md.
struct PlaceConfig {
  std::shared_ptr<const Vocabulary> vocabulary;  ///< null: the one that was built in
  int candidates = 9;             ///< places that a lost frame is compared with before it begins again with the best
  int candidates_per_frame = 2;   ///< so many of them at one frame: bounds the time that it takes
  int min_inliers = 45;           ///< landmarks that a pose needs at a recognised place
  double min_found_ratio = 0.13;  ///< of the landmarks that should be seen there, or of the features if fewer
  int confirmations = 2;          ///< frames that must agree before the pose is given out
  double new_map_after_s = 3.0;   ///< a new map begins after so long with views that nobody knows; 0 = never
};

/// When two places are one, and what follows: docs/theory/loop_closing.md.
struct LoopConfig {
  int max_candidates = 3;             ///< places that each keyframe is compared with
  double min_similarity = 0.75;       ///< of a place, over that of the keyframe's least similar neighbour
  int min_inliers = 50;               ///< landmarks of the place that the keyframe must see
  double min_found_share = 0.15;      ///< of those that it should see
  int confirmations = 3;              ///< keyframes that must ask for the same correction
  int max_misses = 2;                 ///< keyframes in between that find nothing
  double agreement_m = 0.1;           ///< corrections that differ by less are the same
  double agreement_rad = 0.04;        ///< the same for their rotation
  double max_offset_m = 0.3;          ///< a correction is at most this ...
  double max_drift_ratio = 0.05;      ///< ... and this times the way walked since
  double max_offset_rad = 0.1;        ///< the same for its rotation
  double max_drift_rad_m = 0.01;      ///< rad per metre
  int graph_iterations = 30;          ///< of the pose graph
  int global_iterations = 10;         ///< of global bundle adjustment; 0 = none
  double max_odometry_step_m = 0.01;  ///< larger corrections go into map -> odom, smaller ones into the odometry
  double max_odometry_step_rad = 0.005;
};

struct SlamConfig {
  Techniques techniques;
  SensorConfig sensor;
  TrackerConfig tracker;
  PredictionConfig prediction;
  BeliefConfig belief;
  KeyframeConfig keyframe;
  MapperConfig mapper;
  bool localize_only = false;  ///< the map stays as it was loaded
  PlaceConfig place;
  LoopConfig loop;
};

}  // namespace rtd::slam
