// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/config.hpp"

#include <fstream>

#include "services/slam/core/place/vocabulary.hpp"

namespace rtd::slam {
namespace {

using service::ConfigBinder;

void bind_techniques(ConfigBinder& binder, Techniques& t) {
  binder.field("techniques.landmark_belief", t.landmark_belief, "off: landmarks weigh the mean of their observations");
  binder.field("techniques.adaptive_kernel", t.adaptive_kernel, "off: Huber's loss with a fixed threshold");
  binder.field("techniques.rolling_shutter", t.rolling_shutter,
               "off: all rows of the image are taken to be exposed at once");
  binder.field("techniques.prediction", t.prediction, "off: lost at once when nothing static is in view");
  binder.field("techniques.place_recognition", t.place_recognition, "off: found back only around the last pose");
  binder.field("techniques.loop_closing", t.loop_closing, "off: a known place does not correct the map");
}

void bind_sensor(ConfigBinder& binder, SensorConfig& c) {
  binder.field("sensor.disparity_px_m", c.disparity_px_m, {1.0, 10000.0},
               "weight of depth: a disparity of this / depth counts like a pixel");
  binder.field("sensor.close_depth_m", c.close_depth_m, {0.5, 20.0}, "nearer depths make landmarks at once");
  binder.field("sensor.shared_error", c.shared_error, {0.1, 100.0},
               "factor on the covariance of the pose: features share errors of image and depth");
  binder.field("sensor.readout_s", c.readout_s, {-0.1, 0.1},
               "of the image, first row to last, if known; 0: estimated while tracking");
  binder.field("sensor.max_depth_m", c.max_depth_m, {0.5, 50.0}, "farther depths are not used");
}

void bind_tracker(ConfigBinder& binder, TrackerConfig& c) {
  binder.field("tracker.min_initial_points", c.min_initial_points, {10, 2048},
               "features with depth that the first keyframe needs");
  binder.field("tracker.motion_radius_px", c.motion_radius_px, {2.0, 200.0},
               "search radius around the predicted position");
  binder.field("tracker.local_radius_px", c.local_radius_px, {1.0, 20.0},
               "factor on 2.5 / 4 px when the local map is searched");
  binder.field("tracker.min_motion_matches", c.min_motion_matches, {5, 500},
               "matches with the last frame; fewer: try the reference keyframe");
  binder.field("tracker.min_inliers", c.min_inliers, {6, 500}, "landmarks that a pose needs");
  binder.field("tracker.recently_lost_frames", c.recently_lost_frames, {0, 100000},
               "failed frames before tracking counts as lost");
  binder.field("tracker.recovery_keyframes", c.recovery_keyframes, {0, 100}, "keyframes tried per frame while lost");
}

void bind_prediction(ConfigBinder& binder, PredictionConfig& c) {
  binder.field("prediction.max_hold_s", c.max_hold_s, {0.0, 2.0}, "a pose is predicted so long, then tracking is lost");
  binder.field("prediction.velocity_decay_s", c.velocity_decay_s, {0.05, 100.0},
               "time constant of the fading velocity");
  binder.field("prediction.acceleration_m_s2", c.acceleration_m_s2, {0.0, 100.0},
               "standard deviation that the covariance of a prediction grows by");
  binder.field("prediction.acceleration_rad_s2", c.acceleration_rad_s2, {0.0, 100.0}, "the same for the rotation");
  binder.field("prediction.min_weak_inliers", c.min_weak_inliers, {6, 500},
               "landmarks of a pose that is better than a prediction");
}

void bind_belief(ConfigBinder& binder, BeliefConfig& c) {
  binder.field("belief.found", c.found, {0.0, 5.0}, "log odds for a landmark that is found where it should be");
  binder.field("belief.rejected", c.rejected, {0.0, 5.0},
               "against one that does not fit a pose that its neighbours fit");
  binder.field("belief.removed", c.removed, {0.0, 5.0}, "against one that the filter takes for dynamic");
  binder.field("belief.seen_through", c.seen_through, {0.0, 5.0}, "against one behind which depth is measured");
  binder.field("belief.max_log_odds", c.max_log_odds, {2.0, 20.0}, "bound of what is believed");
  binder.field("belief.min_probability", c.min_probability, {0.0, 0.5}, "landmarks below leave the map");
}

void bind_keyframe(ConfigBinder& binder, KeyframeConfig& c) {
  binder.field("keyframe.max_gap_frames", c.max_gap_frames, {1, 10000},
               "a changed view is a keyframe at least so often");
  binder.field("keyframe.min_gap_frames", c.min_gap_frames, {0, 10000},
               "frames between keyframes while tracking is strong");
  binder.field("keyframe.reference_ratio", c.reference_ratio, {0.1, 1.0},
               "tracked / reference landmarks: below, the view is new");
  binder.field("keyframe.weak_ratio", c.weak_ratio, {0.0, 1.0}, "below: insert although the mapper is busy");
  binder.field("keyframe.min_close_tracked", c.min_close_tracked, {0, 2048}, "fewer close landmarks tracked, and ...");
  binder.field("keyframe.min_close_untracked", c.min_close_untracked, {0, 2048},
               "... more close features without landmark: insert");
  binder.field("keyframe.min_inliers", c.min_inliers, {0, 500}, "fewer: no keyframe");
}

void bind_mapper(ConfigBinder& binder, MapperConfig& c) {
  binder.field("mapper.neighbours", c.neighbours, {1, 100}, "covisible keyframes for triangulation and fusion");
  binder.field("mapper.min_found_ratio", c.min_found_ratio, {0.0, 1.0},
               "landmarks found less often than visible are removed");
  binder.field("mapper.redundant_ratio", c.redundant_ratio, {0.5, 1.0},
               "keyframes whose landmarks others see are removed");
  binder.field("mapper.ba_keyframes", c.ba_keyframes, {2, 200}, "keyframes optimised together");
  binder.field("mapper.ba_fixed_keyframes", c.ba_fixed_keyframes, {1, 200}, "keyframes that hold the gauge");
  binder.field("mapper.ba_iterations_robust", c.ba_iterations_robust, {1, 100},
               "iterations before outliers are taken out");
  binder.field("mapper.ba_iterations", c.ba_iterations, {0, 100}, "iterations after");
  binder.field("mapper.correction_m", c.correction_m, {0.0, 1.0}, "a keyframe that moved more is announced again");
  binder.field("mapper.correction_rad", c.correction_rad, {0.0, 1.0}, "the same for its rotation");
}

void bind_place(ConfigBinder& binder, PlaceConfig& c) {
  binder.field("place.candidates", c.candidates, {1, 100}, "places that a lost frame is compared with, in turn");
  binder.field("place.candidates_per_frame", c.candidates_per_frame, {1, 100}, "so many of them at one frame");
  binder.field("place.min_inliers", c.min_inliers, {10, 500}, "landmarks that a pose needs at a recognised place");
  binder.field("place.min_found_ratio", c.min_found_ratio, {0.0, 1.0},
               "of the landmarks that should be seen there, or of the features if fewer");
  binder.field("place.confirmations", c.confirmations, {0, 100},
               "frames that must agree before that pose is given out");
  binder.field("place.new_map_after_s", c.new_map_after_s, {0.0, 1e6},
               "a new map begins after so long with unknown views; 0: never");
}

void bind_loop(ConfigBinder& binder, LoopConfig& c) {
  binder.field("loop.max_candidates", c.max_candidates, {1, 100}, "places that each keyframe is compared with");
  binder.field("loop.min_similarity", c.min_similarity, {0.0, 1.0},
               "of a place, over that of the keyframe's least similar neighbour");
  binder.field("loop.min_inliers", c.min_inliers, {10, 1000}, "landmarks of the place that the keyframe must see");
  binder.field("loop.min_found_share", c.min_found_share, {0.0, 1.0}, "of those that it should see");
  binder.field("loop.confirmations", c.confirmations, {1, 20}, "keyframes that must ask for the same correction");
  binder.field("loop.max_misses", c.max_misses, {0, 20}, "keyframes in between that find nothing");
  binder.field("loop.agreement_m", c.agreement_m, {0.0, 10.0}, "corrections that differ by less are the same");
  binder.field("loop.agreement_rad", c.agreement_rad, {0.0, 1.0}, "the same for their rotation");
  binder.field("loop.max_offset_m", c.max_offset_m, {0.0, 100.0}, "a correction is at most this, and ...");
  binder.field("loop.max_drift_ratio", c.max_drift_ratio, {0.0, 1.0}, "... this times the way walked since");
  binder.field("loop.max_offset_rad", c.max_offset_rad, {0.0, 3.2}, "the same for its rotation, and ...");
  binder.field("loop.max_drift_rad_m", c.max_drift_rad_m, {0.0, 1.0}, "... rad per metre walked since");
  binder.field("loop.graph_iterations", c.graph_iterations, {1, 1000}, "of the pose graph");
  binder.field("loop.global_iterations", c.global_iterations, {0, 100}, "of global bundle adjustment; 0 = none");
  binder.field("loop.max_odometry_step_m", c.max_odometry_step_m, {0.0, 10.0},
               "larger corrections go into map -> odom, smaller ones into the odometry");
  binder.field("loop.max_odometry_step_rad", c.max_odometry_step_rad, {0.0, 1.0}, "the same for its rotation");
}

/// At most one byte more than a vocabulary may have: who names a video by mistake need not wait.
std::vector<std::byte> read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw service::ConfigError("slam.place.vocabulary: cannot read '" + path +
                               "'; leave it empty for the built-in one");
  std::vector<std::byte> bytes(Vocabulary::kMaxBytes + 1);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

}  // namespace

SlamConfig with_vocabulary(const ServiceConfig& config) {
  SlamConfig core = config.core;
  if (config.vocabulary_file.empty()) return core;
  try {
    core.place.vocabulary = std::make_shared<const Vocabulary>(Vocabulary::parse(read_file(config.vocabulary_file)));
  } catch (const VocabularyError& error) {
    throw service::ConfigError("slam.place.vocabulary: '" + config.vocabulary_file + "': " + error.what());
  }
  return core;
}

void ServiceConfig::bind(ConfigBinder& binder) {
  bind_techniques(binder, core.techniques);
  bind_sensor(binder, core.sensor);
  bind_tracker(binder, core.tracker);
  bind_prediction(binder, core.prediction);
  bind_belief(binder, core.belief);
  bind_keyframe(binder, core.keyframe);
  bind_mapper(binder, core.mapper);
  bind_place(binder, core.place);
  binder.field("place.vocabulary", vocabulary_file, "file of rtd-train-vocabulary; empty: the built-in one");
  bind_loop(binder, core.loop);
  binder.field("map.load", map.load, "map file to go on with; empty: a new map");
  binder.field("map.save", map.save, "map file to write at checkpoints and at the end; empty: none");
  binder.field("map.checkpoint_s", map.checkpoint_s, {0.0, 86400.0},
               "time between two checkpoints; 0: only at the end");
  binder.field("map.localize_only", core.localize_only, "find poses in the loaded map and leave it as it is");
  binder.field("out", out_dir, "folder for trajectory.txt, keyframes.txt and map.ply; empty: none");
  binder.field("map_frame", map_frame, "frame of the poses and of the map");
  binder.field("odom_frame", odom_frame, "frame of the odometry: smooth, map -> odom takes up the corrections");
  binder.field("camera_frame", camera_frame, "child frame of the poses: optical");
  binder.field("path_length", path_length, {1, 1000000}, "poses kept for the path message");
  binder.field("path_period_ms", path_period_ms, {1, 60000}, "time between two path messages");
  binder.field("map_period_ms", map_period_ms, {1, 60000}, "time between two point clouds");
}

void ServiceConfig::validate() const {
  if (!core.localize_only) return;
  if (map.load.empty())
    throw service::ConfigError("slam.map.localize_only needs a map: name its file with --map (slam.map.load)");
  if (!map.save.empty())
    throw service::ConfigError("slam.map.save=" + map.save +
                               ": with slam.map.localize_only the map does not change, leave one of the two away");
}

}  // namespace rtd::slam
