// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "common/geometry/depth_noise.hpp"

namespace rtd::filter {

/// Which parts of the filter are at work; the others are compared with it.
enum class FilterMode {
  kOff,       ///< features only: ORB-SLAM2's front end
  kSemantic,  ///< every object of a high motion level is removed, nothing else
  kGeometry,  ///< multi-view geometry only, boxes are not looked at
  kEpipolar,  ///< DS-SLAM's rule: people with moving points on them are removed
  kRtdPaper,  ///< the RTD-SLAM paper's own rules and thresholds
  kRtd,       ///< both, DESIGN section 4
};

/// The techniques of DESIGN section 4, each of which can be left out alone to see what it is worth (`rtd ablate`). A
/// mode uses those that belong to it; one that is off here is off in every mode. docs/theory/dynamic_points.md names
/// each.
struct Techniques {
  // Rule 1: what may move
  bool motion_levels = true;  ///< off: every class of the table counts as high
  // Rule 2: box -> mask
  bool depth_masks = true;   ///< off: the whole box is the object
  bool flat_objects = true;  ///< pictures on walls are left to geometry; off: a poster of a person is a person
  // Rule 3: what moves
  bool depth_check = true;      ///< the multi-view check of range images
  bool feature_votes = true;    ///< displaced features vote for their surface
  bool look_back = true;        ///< very slow movers are looked for over a second
  bool arrivals = true;         ///< what has come and stopped is taken in; off: old views go on condemning it
  bool object_drift = true;     ///< the features of a person are judged together, by their median shift
  bool noise_aware_tau = true;  ///< off: the paper's 0.4 m at every depth
  bool mover_memory = true;     ///< what moved stays masked for a second; off: it must be seen moving in each frame
  bool mover_tracks = true;     ///< movers that were out of sight are known again; off: they are new
  bool surface_poses = true;    ///< surfaces propose the camera's motion; off: all features together only
  // Rule 4: one probability
  bool belief = true;           ///< static probability gathered over time; off: from this frame alone
  bool resting_objects = true;  ///< a person at rest is used again; off: high classes never are
  bool feature_weights = true;  ///< off: what is kept weighs 1
  // Rule 5: missed detections
  bool box_tracks = true;     ///< boxes survive misses and come to every frame; off: only the boxes of this frame
  bool mask_flow = true;      ///< masks carried by optical flow; off: by the box's predicted motion alone
  bool roll_distrust = true;  ///< an empty answer during fast roll is not believed
  // Rule 6: never starve
  bool more_features = true;  ///< 1.5x while something is masked
  bool keep_doubtful = true;  ///< too few left: the best of the doubtful stay
};

/// How ORB features are extracted; docs/theory/orb.md. Defaults as in ORB-SLAM2.
struct OrbConfig {
  int feature_count = 1000;    ///< wanted features per frame
  int levels = 8;              ///< pyramid levels
  double scale_factor = 1.2;   ///< between two levels
  int fast_threshold = 20;     ///< grey values, first try
  int fast_threshold_low = 7;  ///< grey values, in cells where the first try finds nothing
  int cell_px = 30;            ///< side of a FAST cell
  double min_depth_m = 0.3;    ///< nearer readings count as not measured
  double max_depth_m = 10.0;   ///< farther readings count as not measured
};

/// How cells of the depth grid join to clusters; docs/theory/dynamic_points.md Eq. (1).
struct ClusterConfig {
  double step_m = 0.03;  ///< two neighbouring cells join when their depths differ by less than step + factor * z^2
  double step_factor_per_m = 0.012;
  int min_cells = 12;  ///< smaller clusters are nobody's object
};

/// How a box becomes a mask.
struct MaskConfig {
  bool whole_boxes = false;  ///< the box is the object, its depth is not looked at
  double min_share = 0.15;   ///< the object is the nearest cluster with this share of the measured cells of its box
  double max_object_depth_m = 0.5;   ///< cells this far behind or before the object's median depth do not belong to it
  double min_contained = 0.5;        ///< share of a cluster inside the box from which the whole cluster is the object
  double min_outline_step_m = 0.15;  ///< an outline counts as a step when the outside lies this much farther
  double min_outline_share = 0.3;    ///< fewer steps around a mask: a picture on a wall, not an object
  int dilate_cells = 1;              ///< masks grow by this many cells
};

/// Quick pose estimate.
struct EgoMotionConfig {
  double window_px = 30.0;  ///< half side of the search window towards the view 0.1 s ago
  int max_hamming = 64;
  double max_ratio = 0.85;           ///< best to second best distance
  int max_observations = 350;        ///< per pose optimisation
  int min_inliers = 20;              ///< fewer: no pose, geometry makes no statement
  double min_image_share = 0.25;     ///< less of the image agrees on a motion: no pose
  int max_proposals = 6;             ///< surfaces that propose a motion
  int max_proposal_sightings = 100;  ///< per proposal
};

/// Multi-view checks; docs/theory/dynamic_points.md Eq. (3)-(5).
struct GeometryConfig {
  geometry::DepthNoise noise;
  double tau_floor_m = 0.08;         ///< smallest depth difference that says something (the paper: 0.4 m)
  double tau_sigmas = 5.0;           ///< and this many standard deviations of the depth difference
  double max_view_angle_deg = 30.0;  ///< larger angle between the two viewing rays: no statement (paper section III-A)
  double max_baseline_m = 0.8;       ///< keyframes from farther away are not asked: they saw the other side of things
  int max_views = 6;                 ///< reference views per frame
  int min_region_cells = 40;  ///< smaller regions are thin structures that depth cameras see now and then, not movers
  int min_cluster_statements = 30;    ///< cells with a statement before a cluster is judged
  int min_resting_cells = 400;        ///< parts of a dynamic cluster of at least this size may turn out to rest
  double min_resting_ratio = 5.0;     ///< ... if this many times more of their features are at their place than not
  double max_unsettled_share = 0.05;  ///< of a surface seen through by recent views: more, and it has not come to rest
  double min_violated_share = 0.2;    ///< share of violating cells that makes a cluster dynamic
  int min_moving_features = 12;       ///< features off their place before a cluster is judged by them
  double min_moving_share = 0.6;
  int min_creeping_features = 6;  ///< the same, displaced over a second
  double min_creeping_share = 0.7;
  double max_static_chi2 = 6.0;     ///< squared normalised displacement up to which a feature counts as at its place
  double min_moving_chi2 = 16.0;    ///< and from which as moving
  int memory_frames = 30;           ///< a dynamic surface is remembered this long after the last evidence
  int loose_memory_frames = 5;      ///< a dynamic part of a surface that rests as a whole
  double max_dynamic_share = 0.75;  ///< more of the image dynamic: the pose is wrong, no statement
};

/// How the belief that a surface is static grows and fades; docs/theory/dynamic_points.md Eq. (6)-(8).
struct BeliefConfig {
  // What is believed of a surface seen for the first time
  double background_prior = 0.9;  ///< no class, a class of a low level, or a picture on a wall
  double medium_prior = 0.5;
  double high_prior = 0.1;
  // How evidence counts, in log-odds
  double gain_per_s = 10.0;           ///< for each second at rest
  double high_gain_per_s = 2.5;       ///< the same for a high level: somebody who sits down is used after a second
  double highest_probability = 0.99;  ///< evidence adds up to this and no further, so that it can be outweighed
  double high_limit = 0.6;            ///< the same for a high level: rest alone lifts it no higher
  double lowest_probability = 0.05;   ///< what moves falls to this at once
  double forget_s = 2.0;              ///< without a statement a belief returns to the prior with this time constant
  // When an object with a class moves, and when it rests
  double min_moving_cells = 0.2;         ///< share of its cells dynamic: it moves
  int min_moving_votes = 8;              ///< or so many features displaced
  double min_moving_votes_share = 0.35;  ///< ... and this share of those found again
  double drift_sigmas = 4.0;             ///< or the median shift of its features so many standard deviations
  double drift_floor_px = 0.5;           ///< ... of which this much is the pose's
  double max_dynamic_cells = 0.05;       ///< it rests: hardly a cell dynamic (a share)
  double min_lasting_cells = 0.3;        ///< ... this share of its cells there 0.4 s ago
  int min_resting_votes = 12;            ///< ... and so many features at their place
  double min_resting_ratio = 5.0;        ///< ... this many times more than displaced ones
  double min_used_probability = 0.5;     ///< an object believed in at least so much takes part in the quick pose
};

/// Fusion to one probability.
struct FusionConfig {
  double remove_below = 0.25;     ///< features less probably static than this are removed
  int min_static_features = 120;  ///< fewer left: the best of the doubtful are kept
  double boost = 1.5;             ///< times as many features while something is masked
};

/// Noise in units of the box's own size, so that near and far objects are treated alike.
struct BoxNoise {
  double detection = 0.05;      ///< standard deviation of a detected centre or side
  double acceleration = 4.0;    ///< of the object, box sizes / s^2
  double flow = 0.01;           ///< of a shift measured by optical flow from image to image
  double first_velocity = 1.5;  ///< of a box seen once, box sizes / s
};

/// The life of box tracks; docs/theory/dynamic_points.md section 6.
struct BoxTrackConfig {
  BoxNoise noise;
  double min_overlap = 0.15;      ///< intersection over union of a track's box and a detection, less: not the same
  double max_match_cost = 1.0;    ///< 1 - overlap, and what another class and another depth add
  int confirm_hits = 2;           ///< seen less often: the first answer without it ends it
  double survive_misses_s = 0.5;  ///< answers without a confirmed track are believed after this time
  double silence_s = 1.5;         ///< without any answer a track is carried this long
  double fast_roll_deg_s = 30.0;  ///< turning faster about the optical axis: answers without a track do not count
  double roll_patience_s = 3.0;   ///< but not for longer than this
  double unwatched_s = 0.5;       ///< nobody looks for this long: geometry only
};

/// The life of tracks of movers without a class; docs/theory/dynamic_points.md section 4.
struct MoverTrackConfig {
  int confirm_hits = 5;            ///< seen moving less often: no mover yet
  double acceleration_m_s2 = 0.5;  ///< of a mover
  double expect_after_s = 1.0;     ///< since it was last seen moving; before that the memory says where it is
  double rest_s = 1.5;             ///< seen at rest for so long: it has become part of the world
  double gone_s = 0.5;             ///< its place seen without it for so long: it has gone
  double max_unseen_s = 5.0;       ///< not seen moving for longer: it may be anywhere
  double max_unseen_way_m = 0.5;   ///< the same for the way that it may have gone meanwhile
};

/// Mode `epipolar`, DS-SLAM's moving consistency check.
struct EpipolarConfig {
  int max_corners = 1000;
  double corner_distance_px = 8;     ///< between two corners
  int border_px = 5;                 ///< matches that end nearer to the border are dropped
  double max_patch_difference = 25;  ///< mean grey value difference of the 3x3 patches; more: no match
  double ransac_distance_px = 0.2;   ///< of the matches that the fundamental matrix is made of
  double max_distance_px = 1;        ///< farther from the epipolar line: it has moved
  int max_still_points = 5;          ///< more moving points on a person: the person moves
};

/// Mode `rtd-paper`, section III of the paper.
struct PaperConfig {
  double tau_m = 0.4;              ///< depth difference from which something has come
  double max_view_angle_deg = 30;  ///< larger angle between the two viewing rays: no statement
  double max_baseline_m = 0.8;     ///< keyframes from farther away do not overlap
  int keyframes = 5;               ///< overlapping keyframes asked per frame
};

/// Everything the core needs; defaults are the tested values.
struct FilterConfig {
  FilterMode mode = FilterMode::kRtd;
  Techniques techniques;
  OrbConfig orb;
  ClusterConfig clusters;
  MaskConfig masks;
  EgoMotionConfig ego_motion;
  GeometryConfig geometry;
  BeliefConfig belief;
  FusionConfig fusion;
  BoxTrackConfig tracks;
  MoverTrackConfig movers;
  EpipolarConfig epipolar;
  PaperConfig paper;
  std::map<std::string, std::string>
      motion_levels;  ///< class name -> "high" | "medium" | "low" | "none", over the built-in table
};

}  // namespace rtd::filter
