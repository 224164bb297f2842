// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "common/msg/filter_modes.hpp"
#include "services/filter/core/config/motion_config.hpp"

/// Every setting of the core: the member has the default, bind() below it key, range and help text
/// (common/service/config.hpp). The defaults are the tested values.
namespace rtd::filter {

/// The life of box tracks; docs/theory/dynamic_points.md section 6.
struct BoxTrackConfig {
  double survive_misses_s = 0.5;
  double silence_s = 1.5;

  void bind(auto& binder) {
    binder.field("survive_misses_s", survive_misses_s, {0.0, 60.0}, "how long a confirmed track survives misses");
    binder.field("silence_s", silence_s, {0.0, 60.0}, "how long a track is carried without any detections");
  }
};

/// The life of tracks of movers without a class; docs/theory/dynamic_points.md section 4.
struct MoverTrackConfig {
  double rest_s = 1.5;
  double gone_s = 0.5;
  double max_unseen_s = 5.0;

  void bind(auto& binder) {
    binder.field("rest_s", rest_s, {0.0, 60.0}, "seen at rest for this long, it has become part of the world");
    binder.field("gone_s", gone_s, {0.0, 60.0}, "its place seen without it for this long, it has gone");
    binder.field("max_unseen_s", max_unseen_s, {0.0, 60.0}, "not seen moving for longer, it may be anywhere");
  }
};

using msg::FilterMode;

/// The techniques of the filter. Each can be left out alone, to measure what it is worth (`rtd ablate`). A mode uses
/// those that belong to it; one that is off here is off in every mode. docs/theory/dynamic_points.md names each.
struct Techniques {
  // What may move
  bool motion_levels = true, depth_masks = true, flat_objects = true, object_holes = true;
  // What moves
  bool depth_check = true, feature_votes = true, look_back = true, arrivals = true, object_drift = true;
  bool noise_aware_tau = true, mover_memory = true, mover_tracks = true, surface_poses = true;
  // One probability
  bool belief = true, resting_objects = true, feature_weights = true;
  // Missed detections
  bool box_tracks = true, mask_flow = true;
  // Enough features
  bool more_features = true, keep_doubtful = true;
};

/// A technique by name: key `techniques.<name>`.
struct NamedTechnique {
  const char* name;
  bool Techniques::*on;
  const char* without;  ///< what the filter does when the technique is off
};

/// All techniques, in the order of Techniques.
inline constexpr NamedTechnique kTechniques[] = {
    {"motion_levels", &Techniques::motion_levels, "every class of the table counts as high"},
    {"depth_masks", &Techniques::depth_masks, "the whole box is the object"},
    {"flat_objects", &Techniques::flat_objects, "a poster of a person is a person"},
    {"object_holes", &Techniques::object_holes, "cells without depth in a box are background"},
    {"depth_check", &Techniques::depth_check, "no multi-view check of range images"},
    {"feature_votes", &Techniques::feature_votes, "displaced features do not vote for their surface"},
    {"look_back", &Techniques::look_back, "no look back over a second for very slow movers"},
    {"arrivals", &Techniques::arrivals, "old views continue condemning what has arrived and stopped"},
    {"object_drift", &Techniques::object_drift, "a person's features vote one by one, not by their median shift"},
    {"noise_aware_tau", &Techniques::noise_aware_tau, "the paper's 0.4 m at every depth"},
    {"mover_memory", &Techniques::mover_memory, "movers must be seen moving in each frame"},
    {"mover_tracks", &Techniques::mover_tracks, "movers that return to the view are new"},
    {"surface_poses", &Techniques::surface_poses, "surfaces do not propose the camera's motion"},
    {"belief", &Techniques::belief, "static probability from one frame alone"},
    {"resting_objects", &Techniques::resting_objects, "high classes are never used, even at rest"},
    {"feature_weights", &Techniques::feature_weights, "every feature that is kept weighs 1"},
    {"box_tracks", &Techniques::box_tracks, "only the boxes of the frame itself"},
    {"mask_flow", &Techniques::mask_flow, "masks move with the predicted box, without optical flow"},
    {"more_features", &Techniques::more_features, "the same number of features whatever is masked"},
    {"keep_doubtful", &Techniques::keep_doubtful, "too few features stay too few"},
};

/// How ORB features are extracted; docs/theory/orb.md. Defaults as in ORB-SLAM2.
struct OrbConfig {
  int feature_count = 1000;
  int levels = 8;
  double scale_factor = 1.2;
  int fast_threshold = 20;
  int fast_threshold_low = 7;
  int cell_px = 30;
  double min_depth_m = 0.3;
  double max_depth_m = 10.0;

  void bind(auto& binder) {
    binder.field("feature_count", feature_count, {100, 2700}, "wanted features per frame");
    binder.field("levels", levels, {1, 12}, "pyramid levels");
    binder.field("scale_factor", scale_factor, {1.05, 2.0}, "between two levels");
    binder.field("fast_threshold", fast_threshold, {1, 255}, "grey values, first attempt");
    binder.field("fast_threshold_low", fast_threshold_low, {1, 255}, "grey values, where the first attempt finds none");
    binder.field("cell_px", cell_px, {10, 200}, "side of a FAST cell");
    binder.field("min_depth_m", min_depth_m, {0.0, 10.0}, "nearer readings count as not measured");
    binder.field("max_depth_m", max_depth_m, {0.5, 50.0}, "farther readings count as not measured");
  }
};

/// How cells of the depth grid join to clusters; docs/theory/dynamic_points.md Eq. (1).
struct ClusterConfig {
  double step_m = 0.03;

  void bind(auto& binder) {
    binder.field("step_m", step_m, {0.001, 1.0}, "depth step that separates neighbouring cells");
  }
};

/// How a box becomes a mask.
struct MaskConfig {
  bool whole_boxes = false;          ///< the box is the object, whatever its depth
  bool holes = true;                 ///< cells without depth next to an object belong to it
  double max_object_depth_m = 0.5;   ///< cells farther from the object's median depth do not belong to it
  double min_outline_step_m = 0.15;  ///< depth step at the outline of an object
  double min_outline_share = 0.3;    ///< share of the outline with such a step; less: a picture on a wall
  int dilate_cells = 1;              ///< masks grow by this many cells
};

/// How the belief that a surface is static grows and fades; docs/theory/dynamic_points.md Eq. (6)-(8).
struct BeliefConfig {
  double background_prior = 0.9;
  double medium_prior = 0.5;
  double high_prior = 0.1;
  double high_gain_per_s = 2.5;
  double highest_probability = 0.99;
  double high_limit = 0.6;
  double lowest_probability = 0.05;
  double drift_sigmas = 4.0;
  double drift_floor_px = 0.5;

  void bind(auto& binder) {
    binder.field("background_prior", background_prior, {0.0, 1.0},
                 "static probability of a new surface: no class, a low level, or a picture on a wall");
    binder.field("medium_prior", medium_prior, {0.0, 1.0}, "the same on an object of a medium level");
    binder.field("high_prior", high_prior, {0.0, 1.0}, "the same on an object of a high level");
    binder.field("high_gain_per_s", high_gain_per_s, {0.0, 1000.0}, "the same for a high level");
    binder.field("highest_probability", highest_probability, {0.5, 1.0},
                 "evidence adds up to this and no further, so that it can be outweighed");
    binder.field("high_limit", high_limit, {0.0, 1.0}, "the same for a high level");
    binder.field("lowest_probability", lowest_probability, {0.0, 0.5}, "what moves falls to this at once");
    binder.field("drift_sigmas", drift_sigmas, {0.5, 1000.0},
                 "or their median shift longer than this many standard deviations");
    binder.field("drift_floor_px", drift_floor_px, {0.0, 100.0}, "... to which the pose adds this much, px");
  }
};

/// Fusion to one probability.
struct FusionConfig {
  double remove_below = 0.25;
  int min_static_features = 120;
  double boost = 1.5;

  void bind(auto& binder) {
    binder.field("remove_below", remove_below, {0.0, 1.0}, "features less probably static are removed");
    binder.field("min_static_features", min_static_features, {0, 2048},
                 "if fewer are left, the best of the doubtful are kept");
    binder.field("boost", boost, {1.0, 2.0}, "times as many features while something is masked");
  }
};

/// Mode `epipolar`, DS-SLAM's moving consistency check.
struct EpipolarConfig {
  int max_still_points = 5;

  void bind(auto& binder) {
    binder.field("max_still_points", max_still_points, {0, 1000},
                 "mode epipolar: with more moving points on a person, the person moves");
  }
};

/// Mode `rtd-paper`, section III of the paper.
struct PaperConfig {
  double tau_m = 0.4;
  double max_view_angle_deg = 30;
  double max_baseline_m = 0.8;
  int keyframes = 5;

  void bind(auto& binder) {
    binder.field("tau_m", tau_m, {0.01, 2.0}, "mode rtd-paper: depth difference of a mover");
    binder.field("max_view_angle_deg", max_view_angle_deg, {1.0, 90.0},
                 "mode rtd-paper: no statement at a larger angle between the two viewing rays");
    binder.field("max_baseline_m", max_baseline_m, {0.01, 10.0},
                 "mode rtd-paper: keyframes from farther away do not overlap");
    binder.field("keyframes", keyframes, {1, 16}, "mode rtd-paper: overlapping keyframes used per frame");
  }
};

/// Everything the core needs.
struct FilterConfig {
  FilterMode mode = FilterMode::kRtd;  ///< key `mode`, by name: ServiceConfig
  Techniques techniques;
  OrbConfig orb;
  ClusterConfig clusters;
  MaskConfig masks;
  EgoMotionConfig ego_motion;
  GyroscopeConfig gyroscope;
  GeometryConfig geometry;
  BeliefConfig belief;
  FusionConfig fusion;
  BoxTrackConfig tracks;
  MoverTrackConfig movers;
  EpipolarConfig epipolar;
  PaperConfig paper;
  std::map<std::string, std::string> motion_levels;

  void bind(auto& binder) {
    for (const NamedTechnique& technique : kTechniques) {
      binder.field(std::string("techniques.") + technique.name, techniques.*technique.on,
                   std::string("off: ") + technique.without);
    }
    binder.section("orb", orb);
    binder.section("clusters", clusters);
    binder.section("ego", ego_motion);
    binder.section("imu", gyroscope);
    binder.section("geometry", geometry);
    binder.section("belief", belief);
    binder.section("fusion", fusion);
    binder.section("movers", movers);
    binder.section("epipolar", epipolar);
    binder.section("paper", paper);
    binder.section("tracks", tracks);
    binder.field("motion_levels", motion_levels, "class -> high, medium, low, none; over the built-in table");
  }
};

}  // namespace rtd::filter
