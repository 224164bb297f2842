// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <memory>

namespace rtd::slam {

class Vocabulary;

/// Every number of the SLAM core: default next to the member, key, range and meaning in bind().

/// One switch for each technique beyond ORB-SLAM2's tracking and mapping, so that its worth can be measured.
struct Techniques {
  bool adaptive_kernel = true;
  bool rolling_shutter = true;
  bool prediction = true;
  bool place_recognition = true;
  bool loop_closing = true;
  bool beyond_range = true;

  void bind(auto& binder) {
    binder.field("adaptive_kernel", adaptive_kernel,
                 "the robust loss is fitted to the residuals; off: Huber with a fixed threshold");
    binder.field("rolling_shutter", rolling_shutter,
                 "the readout time of the image is estimated and undone; off: all rows are exposed at once");
    binder.field("prediction", prediction,
                 "a short, marked prediction when nothing static is in view; off: lost at once");
    binder.field("place_recognition", place_recognition,
                 "a lost camera is found at places that it knows; off: only around its last pose");
    binder.field("loop_closing", loop_closing, "known places correct the map; off: drift stays");
    binder.field("beyond_range", beyond_range,
                 "where little has depth, what is too far for the sensor is tracked at once; off: once triangulated");
  }
};

/// The camera and its features, as SLAM weighs them.
struct SensorConfig {
  double disparity_px_m = 0;  ///< vision::RgbdProjection::disparity_px_m
  double close_depth_m = 4.0;
  double shared_error = 3.0;
  double calibration_error = 0.01;
  double readout_s = 0;
  double max_depth_m = 8.0;

  void bind(auto& binder) {
    binder.field("disparity_px_m", disparity_px_m, {0.0, 10000.0},
                 "weight of depth: a disparity of this / depth counts like a pixel; 0: estimated while tracking");
    binder.field("close_depth_m", close_depth_m, {0.5, 20.0},
                 "nearer depths make landmarks at once, farther ones wait for a second view");
    binder.field("shared_error", shared_error, {0.1, 100.0},
                 "factor on the covariance of the pose: features share errors of image and depth");
    binder.field(
        "calibration_error", calibration_error, {0.0, 0.5},
        "share by which focal length and depth may be off: the covariance grows by it with the way from the origin");
    binder.field(
        "readout_s", readout_s, {-0.1, 0.1},
        "readout time of the image, first row to last, if known; 0: that of the frames, or estimated while tracking");
    binder.field("max_depth_m", max_depth_m, {0.5, 50.0}, "farther depths are not used");
  }
};

struct TrackerConfig {
  int min_initial_points = 100;
  double motion_turn_rad_s = 0.86;
  double local_radius_px = 3.0;
  int min_motion_matches = 20;
  int min_inliers = 30;
  double recently_lost_s = 1.0;
  int recovery_keyframes = 3;
  double inertia_m_s2 = 10;
  double max_speed_m_s = 3;
  double max_acceleration_m_s2 = 30;

  void bind(auto& binder) {
    binder.field("min_initial_points", min_initial_points, {10, 2048},
                 "features with depth that the first keyframe needs");
    binder.field("motion_turn_rad_s", motion_turn_rad_s, {0.05, 20.0},
                 "landmarks are searched around their predicted place as far as this turns them since the last frame");
    binder.field("local_radius_px", local_radius_px, {1.0, 20.0},
                 "factor on 2.5 / 4 px when the local map is searched");
    binder.field("min_motion_matches", min_motion_matches, {5, 500},
                 "matches with the last frame; with fewer, the reference keyframe is tried");
    binder.field("min_inliers", min_inliers, {6, 500}, "landmarks that a pose needs to count as tracked");
    binder.field("recently_lost_s", recently_lost_s, {0.0, 1000.0},
                 "without a pose for longer, 'recently lost' becomes 'lost'");
    binder.field("inertia_m_s2", inertia_m_s2, {0.0, 1000.0},
                 "standard deviation of the hand's acceleration, as poses weigh it against landmarks; 0: they do not");
    binder.field("max_speed_m_s", max_speed_m_s, {0.1, 1000.0},
                 "a pose that is reached only faster is doubtful, if neither IMU nor wheels agree, and so is one ...");
    binder.field("max_acceleration_m_s2", max_acceleration_m_s2, {0.1, 100000.0}, "... that needs more than this");
    binder.field("recovery_keyframes", recovery_keyframes, {0, 100}, "keyframes tried in each frame while lost");
  }
};

/// Which landmarks carry a pose: docs/theory/tracking.md, "Witnesses".
struct WitnessConfig {
  bool used = true;
  double after_s = 0.5;
  double settle_s = 2;
  double probation_share = 0.2;
  int enough = 30;
  double found_share = 0.4;
  double decisive_share = 0.2;
  double wide_share = 0.35;

  void bind(auto& binder) {
    binder.field("used", used, "landmarks that have been seen to rest carry the pose; off: all alike");
    binder.field("after_s", after_s, {0.0, 60.0}, "a landmark that was seen to rest for so long is a witness");
    binder.field(
        "settle_s", settle_s, {0.0, 60.0},
        "poses in a new map, or after a contradiction by witnesses, are doubtful until witnesses carry one, but "
        "for no longer than this");
    binder.field("probation_share", probation_share, {0.0, 100.0},
                 "all other landmarks together have at most this share of the witnesses' influence on the pose, "
                 "more where those are few");
    binder.field("enough", enough, {1, 2048}, "so many witnesses carry a pose, wherever they are in the image, or ...");
    binder.field("found_share", found_share, {0.0, 1.0}, "... this share of the tiles where witnesses should be seen");
    binder.field(
        "decisive_share", decisive_share, {0.0, 1.0},
        "where witnesses are expected in this share of the tiles with features, a pose without them is doubtful");
    binder.field("wide_share", wide_share, {0.0, 1.0},
                 "with fewer, landmarks that agree in this share of the tiles carry the pose: a new view");
  }
};

/// What is claimed of the pose while nothing static is in view: docs/theory/tracking.md, "Prediction".
struct PredictionConfig {
  double max_hold_s = 0.5;
  double velocity_decay_s = 0.5;
  double acceleration_m_s2 = 1.0;
  double acceleration_rad_s2 = 3.0;
  int min_weak_inliers = 12;

  void bind(auto& binder) {
    binder.field("max_hold_s", max_hold_s, {0.0, 2.0}, "a pose is predicted for so long, then tracking is lost");
    binder.field("velocity_decay_s", velocity_decay_s, {0.05, 100.0}, "time constant of the fading velocity");
    binder.field("acceleration_m_s2", acceleration_m_s2, {0.0, 100.0},
                 "standard deviation of the hand's acceleration: the covariance grows by it");
    binder.field("acceleration_rad_s2", acceleration_rad_s2, {0.0, 100.0}, "the same for the rotation");
    binder.field("min_weak_inliers", min_weak_inliers, {6, 500},
                 "landmarks of a pose that is too weak to count as tracked but better than a prediction");
  }
};

/// When a measured pose is doubtful: docs/theory/tracking.md, "Consistency".
struct ConsistencyConfig {
  double doubtful_below = 0.42;
  double usual = 0.55;
  double memory_s = 0.5;

  void bind(auto& binder) {
    binder.field(
        "doubtful_below", doubtful_below, {0.0, 1.0},
        "share of the matched landmarks that agree with the pose, less if they agree loosely; 0: never doubtful");
    binder.field("usual", usual, {0.05, 1.0}, "below this share the covariance grows");
    binder.field("memory_s", memory_s, {0.01, 60.0}, "time constant of the share");
  }
};

/// When a frame becomes a keyframe: docs/theory/tracking.md, "Keyframes".
struct KeyframeConfig {
  double max_gap_s = 1.0;
  double min_gap_s = 0.1;
  double reference_ratio = 0.9;
  double weak_ratio = 0.25;
  int min_close_tracked = 100;
  int min_close_untracked = 70;
  int min_inliers = 15;

  void bind(auto& binder) {
    binder.field("max_gap_s", max_gap_s, {0.0, 1000.0}, "a changed view becomes a keyframe at least so often");
    binder.field("min_gap_s", min_gap_s, {0.0, 1000.0}, "between keyframes while tracking is strong");
    binder.field("reference_ratio", reference_ratio, {0.1, 1.0},
                 "tracked / reference landmarks: below, the view is new");
    binder.field("weak_ratio", weak_ratio, {0.0, 1.0}, "below, a keyframe is inserted although the mapper is busy");
    binder.field("min_close_tracked", min_close_tracked, {0, 2048}, "with fewer close landmarks tracked and ...");
    binder.field("min_close_untracked", min_close_untracked, {0, 2048},
                 "... more close features without landmark, a keyframe is inserted");
    binder.field("min_inliers", min_inliers, {0, 500}, "with fewer landmarks a keyframe would harm");
  }
};

struct MapperConfig {
  int neighbours = 10;
  double min_found_ratio = 0.25;
  double redundant_ratio = 0.9;
  double old_redundant_ratio = 0.7;
  double old_after_s = 120.0;
  double ba_gap_s = 0.1;
  int ba_keyframes = 12;
  int ba_fixed_keyframes = 20;
  int ba_iterations_robust = 3;
  int ba_iterations = 1;
  double correction_m = 0.002;
  double correction_rad = 0.001;

  void bind(auto& binder) {
    binder.field("neighbours", neighbours, {1, 100}, "covisible keyframes for triangulation and fusion");
    binder.field("min_found_ratio", min_found_ratio, {0.0, 1.0},
                 "landmarks found less often than they should be seen are removed");
    binder.field("redundant_ratio", redundant_ratio, {0.5, 1.0},
                 "keyframes are removed when three others see this share of their landmarks");
    binder.field("old_redundant_ratio", old_redundant_ratio, {0.5, 1.0},
                 "the same for old keyframes, so that a map of one place does not grow for hours");
    binder.field("old_after_s", old_after_s, {0.0, 1e9}, "a keyframe is old after that long");
    binder.field("ba_gap_s", ba_gap_s, {0.0, 10.0}, "local bundle adjustments are so far apart, once a map has grown");
    binder.field("ba_keyframes", ba_keyframes, {2, 200}, "keyframes that local bundle adjustment optimises");
    binder.field("ba_fixed_keyframes", ba_fixed_keyframes, {1, 200}, "keyframes that hold the gauge");
    binder.field("ba_iterations_robust", ba_iterations_robust, {1, 100},
                 "iterations with Huber's loss, before outliers are taken out");
    binder.field("ba_iterations", ba_iterations, {0, 100}, "iterations after that, on inliers; 0: no second stage");
    binder.field("correction_m", correction_m, {0.0, 1.0}, "a keyframe that moved more is announced again");
    binder.field("correction_rad", correction_rad, {0.0, 1.0}, "the same for its rotation");
  }
};

/// How places are recognised: docs/theory/place_recognition.md.
struct PlaceConfig {
  std::shared_ptr<const Vocabulary> vocabulary;  ///< null: the built-in one
  int candidates = 9;
  int candidates_per_frame = 2;
  int min_inliers = 45;
  double min_found_ratio = 0.13;
  int confirmations = 2;
  double new_map_after_s = 3.0;

  void bind(auto& binder) {
    binder.field("candidates", candidates, {1, 100},
                 "places that a lost frame is compared with before it starts again with the best");
    binder.field("candidates_per_frame", candidates_per_frame, {1, 100}, "of these, how many are tried at one frame");
    binder.field("min_inliers", min_inliers, {10, 500}, "landmarks that a pose needs at a recognised place");
    binder.field("min_found_ratio", min_found_ratio, {0.0, 1.0},
                 "of the landmarks that should be seen there, or of the features if fewer");
    binder.field("confirmations", confirmations, {0, 100}, "frames that must agree before that pose is published");
    binder.field("new_map_after_s", new_map_after_s, {0.0, 1e6},
                 "a new map begins after so long with unknown views; 0: never");
  }
};

/// When two places are one, and what follows: docs/theory/loop_closing.md.
struct LoopConfig {
  int max_candidates = 3;
  double min_similarity = 0.75;
  int min_inliers = 50;
  double min_found_share = 0.15;
  int confirmations = 3;
  int max_misses = 2;
  double agreement_m = 0.1;
  double agreement_rad = 0.04;
  double max_offset_m = 0.3;
  double max_drift_ratio = 0.05;
  double max_offset_rad = 0.1;
  double max_drift_rad_m = 0.01;
  int graph_iterations = 30;
  int global_iterations = 10;
  double max_odometry_step_m = 0.01;
  double max_odometry_step_rad = 0.005;

  void bind(auto& binder) {
    binder.field("max_candidates", max_candidates, {1, 100}, "places that each keyframe is compared with");
    binder.field("min_similarity", min_similarity, {0.0, 1.0},
                 "of a place, relative to the keyframe's least similar neighbour");
    binder.field("min_inliers", min_inliers, {10, 1000}, "landmarks of the place that the keyframe must see");
    binder.field("min_found_share", min_found_share, {0.0, 1.0}, "of those that it should see");
    binder.field("confirmations", confirmations, {1, 20}, "keyframes that must ask for the same correction");
    binder.field("max_misses", max_misses, {0, 20}, "keyframes in between that find nothing");
    binder.field("agreement_m", agreement_m, {0.0, 10.0}, "corrections that differ by less are the same");
    binder.field("agreement_rad", agreement_rad, {0.0, 1.0}, "the same for their rotation");
    binder.field("max_offset_m", max_offset_m, {0.0, 100.0}, "a correction is at most this, and ...");
    binder.field("max_drift_ratio", max_drift_ratio, {0.0, 1.0}, "... this times the distance travelled since");
    binder.field("max_offset_rad", max_offset_rad, {0.0, 3.2}, "the same for its rotation, and ...");
    binder.field("max_drift_rad_m", max_drift_rad_m, {0.0, 1.0}, "... rad per metre travelled since");
    binder.field("graph_iterations", graph_iterations, {1, 1000}, "of the pose graph");
    binder.field("global_iterations", global_iterations, {0, 100}, "of global bundle adjustment; 0: none");
    binder.field("max_odometry_step_m", max_odometry_step_m, {0.0, 10.0},
                 "larger corrections go into map -> odom, smaller ones into the odometry");
    binder.field("max_odometry_step_rad", max_odometry_step_rad, {0.0, 1.0}, "the same for its rotation");
  }
};

/// What says which way is up when a map begins; docs/frames.md.
enum class Gravity {
  kLevel,  ///< first_pose
  kFloor,  ///< the floor in the image
  kImu,    ///< the IMU of SlamConfig::prior
};

/// An IMU next to the camera, as its data sheet says: docs/theory/inertial.md.
struct ImuConfig {
  double gyro_rad_s_rthz = 2e-4;
  double accel_m_s2_rthz = 2e-3;
  double gyro_walk_rad_s2_rthz = 2e-5;
  double accel_walk_m_s3_rthz = 2e-4;
  double gyro_bias_rad_s = 0.02;
  double accel_bias_m_s2 = 0.05;
  double gravity_m_s2 = 9.80665;
  double time_offset_s = 0;
  double ready_m_s = 0.1;
  double ready_rad_s = 0.005;

  void bind(auto& binder) {
    binder.field("gyro_rad_s_rthz", gyro_rad_s_rthz, {1e-7, 1.0}, "noise density of the gyroscope, rad/s per root Hz");
    binder.field("accel_m_s2_rthz", accel_m_s2_rthz, {1e-6, 10.0}, "of the accelerometer, m/s2 per root Hz");
    binder.field("gyro_walk_rad_s2_rthz", gyro_walk_rad_s2_rthz, {0.0, 1.0},
                 "how fast the gyroscope's bias wanders, rad/s2 per root Hz");
    binder.field("accel_walk_m_s3_rthz", accel_walk_m_s3_rthz, {0.0, 10.0},
                 "how fast the accelerometer's bias wanders, m/s3 per root Hz");
    binder.field("gyro_bias_rad_s", gyro_bias_rad_s, {1e-6, 1.0}, "standard deviation of the gyroscope's first bias");
    binder.field("accel_bias_m_s2", accel_bias_m_s2, {1e-5, 5.0}, "of the accelerometer's first bias");
    binder.field("gravity_m_s2", gravity_m_s2, {9.7, 9.9}, "strength of gravity where the robot is");
    binder.field("time_offset_s", time_offset_s, {-0.5, 0.5}, "added to the stamps of the samples");
    binder.field("ready_m_s", ready_m_s, {0.001, 10.0},
                 "predictions begin once the velocity is known to this standard deviation, and ...");
    binder.field("ready_rad_s", ready_rad_s, {1e-5, 1.0}, "... the gyroscope's bias to this");
  }
};

/// Odometry of the wheels: docs/theory/inertial.md, "Wheels".
struct WheelConfig {
  double distance_share = 0.03;
  double turn_share = 0.05;
  double turn_rad_m = 0.02;
  double still_m = 0.0005;
  double off_plane_share = 0.01;

  void bind(auto& binder) {
    binder.field("distance_share", distance_share, {1e-4, 1.0}, "standard deviation of a distance, share of it");
    binder.field("turn_share", turn_share, {1e-4, 1.0}, "standard deviation of a turn, share of its angle, and ...");
    binder.field("turn_rad_m", turn_rad_m, {0.0, 1.0}, "... rad per metre of distance");
    binder.field("still_m", still_m, {1e-6, 0.1}, "standard deviation of the distance between two frames at rest");
    binder.field("off_plane_share", off_plane_share, {0.0, 1.0},
                 "height, roll and pitch, which wheels do not show: m per m and rad per m of distance");
  }
};

/// Where a pose is expected when an IMU or wheels say how the camera moved.
struct PriorConfig {
  bool imu = false, wheels = false;  ///< which of them there are
  Eigen::Isometry3d T_camera_imu = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();  ///< of the wheels' base
  double max_sigma_m = 0.10;
  double max_hold_s = 10;
  double contradiction = 8;
  double weak_support = 0.4;
  double visual_factor = 4;
  double covered_share = 0.5;
  double covered_factor = 25;
  bool known_rotation = false;

  void bind(auto& binder) {
    binder.field("max_sigma_m", max_sigma_m, {0.001, 10.0},
                 "with an IMU or wheels a pose is predicted while its position is known to this, and ...");
    binder.field("max_hold_s", max_hold_s, {0.0, 3600.0}, "... for at most so long");
    binder.field("contradiction", contradiction, {3.0, 1000.0},
                 "a measured pose so many standard deviations off the predicted one is not believed, unless ...");
    binder.field("weak_support", weak_support, {0.0, 1.0},
                 "... this share of the landmarks that should be seen, or of the features, agree with it");
    binder.field("visual_factor", visual_factor, {0.1, 1000.0},
                 "factor on the covariance of measured poses: their errors last for several frames");
    binder.field("covered_share", covered_share, {0.0, 1.0},
                 "a view with fewer than this share of the usual static features is covered: its pose is weighed "
                 "against the expected one, and no keyframe is made of it");
    binder.field("covered_factor", covered_factor, {0.1, 1000.0},
                 "the factor for poses of covered views: what is left to be seen has the same errors for long");
    binder.field("known_rotation", known_rotation, "the turn by the gyroscope is one more residual of every pose");
  }
  bool given() const { return imu || wheels; }
};

struct SlamConfig {
  Techniques techniques;
  SensorConfig sensor;
  TrackerConfig tracker;
  WitnessConfig witness;
  PredictionConfig prediction;
  PriorConfig prior;
  ImuConfig imu;
  WheelConfig wheel;
  ConsistencyConfig consistency;
  KeyframeConfig keyframe;
  MapperConfig mapper;
  bool localize_only = false;  ///< the map stays as it was loaded
  PlaceConfig place;
  LoopConfig loop;
  /// T_world_camera of the first frame of each map: says where the world is, and which way is up in it.
  Eigen::Isometry3d first_pose = Eigen::Isometry3d::Identity();
  /// Otherwise: z of the world is up. It is turned about its origin from where first_pose has it.
  Gravity gravity = Gravity::kLevel;
  int gravity_wait_frames = 30;  ///< the first map waits so long, then first_pose is right
};

}  // namespace rtd::slam
