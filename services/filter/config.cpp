// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/config.hpp"

#include "common/vision/motion_levels.hpp"
#include "services/filter/core/modes/mode_table.hpp"

namespace rtd::filter {
namespace {

using service::ConfigBinder;

void bind_techniques(ConfigBinder& binder, Techniques& techniques) {
  for (const NamedTechnique& technique : all_techniques()) {
    binder.field(std::string("techniques.") + technique.name, techniques.*technique.on,
                 std::string("off: ") + technique.without);
  }
}

void bind_orb(ConfigBinder& binder, OrbConfig& c) {
  binder.field("orb.feature_count", c.feature_count, {100, 1300}, "wanted features per frame");
  binder.field("orb.levels", c.levels, {1, 12}, "pyramid levels");
  binder.field("orb.scale_factor", c.scale_factor, {1.05, 2.0}, "between two levels");
  binder.field("orb.fast_threshold", c.fast_threshold, {1, 255}, "grey values, first try");
  binder.field("orb.fast_threshold_low", c.fast_threshold_low, {1, 255}, "where the first try finds nothing");
  binder.field("orb.cell_px", c.cell_px, {10, 200}, "side of a FAST cell");
  binder.field("orb.min_depth_m", c.min_depth_m, {0.0, 10.0}, "nearer readings count as not measured");
  binder.field("orb.max_depth_m", c.max_depth_m, {0.5, 50.0}, "farther readings count as not measured");
}

void bind_surfaces(ConfigBinder& binder, ClusterConfig& clusters, MaskConfig& masks) {
  binder.field("clusters.step_m", clusters.step_m, {0.001, 1.0}, "depth step that separates neighbouring cells");
  binder.field("clusters.step_factor_per_m", clusters.step_factor_per_m, {0.0, 1.0}, "plus this times depth squared");
  binder.field("clusters.min_cells", clusters.min_cells, {1, 10000}, "smaller clusters are nobody's object");
  binder.field("masks.min_share", masks.min_share, {0.01, 1.0}, "share of the box that the nearest cluster needs");
  binder.field("masks.max_object_depth_m", masks.max_object_depth_m, {0.05, 5.0},
               "depth of an object about its median");
  binder.field("masks.min_contained", masks.min_contained, {0.0, 1.0},
               "share inside the box: the whole cluster is the object");
  binder.field("masks.min_outline_step_m", masks.min_outline_step_m, {0.0, 5.0},
               "depth step at the outline of an object");
  binder.field("masks.min_outline_share", masks.min_outline_share, {0.0, 1.0}, "fewer steps: a picture on a wall");
  binder.field("masks.dilate_cells", masks.dilate_cells, {0, 10}, "masks grow by so many cells");
}

void bind_ego_motion(ConfigBinder& binder, EgoMotionConfig& c) {
  binder.field("ego.window_px", c.window_px, {2.0, 200.0}, "half side of the search window");
  binder.field("ego.max_hamming", c.max_hamming, {1, 256}, "largest descriptor distance of a match");
  binder.field("ego.max_ratio", c.max_ratio, {0.1, 1.0}, "best to second best distance");
  binder.field("ego.max_observations", c.max_observations, {20, 2048}, "per pose optimisation");
  binder.field("ego.min_inliers", c.min_inliers, {6, 1000}, "fewer: no pose, geometry makes no statement");
  binder.field("ego.min_image_share", c.min_image_share, {0.0, 1.0}, "less of the image agrees: no pose");
  binder.field("ego.max_proposals", c.max_proposals, {0, 64}, "surfaces that propose a motion");
  binder.field("ego.max_proposal_sightings", c.max_proposal_sightings, {6, 2048}, "features per proposal");
}

void bind_geometry(ConfigBinder& binder, GeometryConfig& c) {
  binder.field("geometry.noise_offset_m", c.noise.offset_m, {0.0, 0.1}, "depth noise: this");
  binder.field("geometry.noise_factor_per_m", c.noise.factor_per_m, {0.0, 0.1}, "plus this times depth squared");
  binder.field("geometry.tau_floor_m", c.tau_floor_m, {0.01, 2.0}, "smallest depth difference that says something");
  binder.field("geometry.tau_sigmas", c.tau_sigmas, {1.0, 50.0}, "and so many standard deviations");
  binder.field("geometry.max_view_angle_deg", c.max_view_angle_deg, {1.0, 90.0}, "larger angle: no statement");
  binder.field("geometry.max_baseline_m", c.max_baseline_m, {0.01, 10.0}, "keyframes from farther away: not asked");
  binder.field("geometry.max_views", c.max_views, {1, 30}, "reference views per frame");
  binder.field("geometry.min_cluster_statements", c.min_cluster_statements, {1, 10000}, "before a cluster is judged");
  binder.field("geometry.min_violated_share", c.min_violated_share, {0.01, 1.0}, "that makes a cluster dynamic");
  binder.field("geometry.max_unsettled_share", c.max_unsettled_share, {0.0, 1.0},
               "of a surface seen through by recent views: it has not come to rest");
  binder.field("geometry.min_region_cells", c.min_region_cells, {1, 10000}, "smaller moving regions are noise");
  binder.field("geometry.min_resting_cells", c.min_resting_cells, {1, 100000},
               "a part of a moving surface may rest from this size");
  binder.field("geometry.min_resting_ratio", c.min_resting_ratio, {1.0, 1000.0},
               "so many times more features at their place than displaced: at rest");
  binder.field("geometry.min_moving_features", c.min_moving_features, {1, 2048}, "before a surface is judged by them");
  binder.field("geometry.min_moving_share", c.min_moving_share, {0.05, 1.0}, "of its features displaced: it moves");
  binder.field("geometry.min_creeping_features", c.min_creeping_features, {1, 2048},
               "the same over a second, for slow movers");
  binder.field("geometry.min_creeping_share", c.min_creeping_share, {0.05, 1.0},
               "of its features displaced over a second: it moves");
  binder.field("geometry.max_static_chi2", c.max_static_chi2, {0.1, 100.0}, "a feature displaced less is at its place");
  binder.field("geometry.min_moving_chi2", c.min_moving_chi2, {0.1, 1000.0}, "one displaced more has moved");
  binder.field("geometry.memory_frames", c.memory_frames, {0, 255}, "a dynamic surface is remembered so long");
  binder.field("geometry.loose_memory_frames", c.loose_memory_frames, {0, 255}, "a moving part of a resting surface");
  binder.field("geometry.max_dynamic_share", c.max_dynamic_share, {0.1, 1.0},
               "more of the image dynamic: no statement");
}

void bind_belief(ConfigBinder& binder, BeliefConfig& c) {
  binder.field("belief.background_prior", c.background_prior, {0.0, 1.0}, "static probability of a new surface");
  binder.field("belief.medium_prior", c.medium_prior, {0.0, 1.0}, "the same on an object of a medium level");
  binder.field("belief.high_prior", c.high_prior, {0.0, 1.0}, "the same on an object of a high level");
  binder.field("belief.gain_per_s", c.gain_per_s, {0.0, 1000.0}, "log-odds for each second at rest");
  binder.field("belief.high_gain_per_s", c.high_gain_per_s, {0.0, 1000.0}, "the same for a high level");
  binder.field("belief.highest_probability", c.highest_probability, {0.5, 1.0}, "evidence adds up to this");
  binder.field("belief.high_limit", c.high_limit, {0.0, 1.0}, "the same for a high level");
  binder.field("belief.lowest_probability", c.lowest_probability, {0.0, 0.5}, "what moves falls to this");
  binder.field("belief.forget_s", c.forget_s, {0.01, 1000.0}, "without a statement: back to the prior");
  binder.field("belief.min_moving_cells", c.min_moving_cells, {0.01, 1.0}, "share dynamic: the object moves");
  binder.field("belief.min_moving_votes", c.min_moving_votes, {1, 2048}, "or so many of its features displaced");
  binder.field("belief.min_moving_votes_share", c.min_moving_votes_share, {0.01, 1.0}, "... and this share of them");
  binder.field("belief.drift_sigmas", c.drift_sigmas, {0.5, 1000.0},
               "or their median shift so many standard deviations");
  binder.field("belief.drift_floor_px", c.drift_floor_px, {0.0, 100.0}, "of which the pose has this much, px");
  binder.field("belief.max_dynamic_cells", c.max_dynamic_cells, {0.0, 1.0}, "share dynamic: less, it may rest");
  binder.field("belief.min_lasting_cells", c.min_lasting_cells, {0.0, 1.0}, "... this share there 0.4 s ago");
  binder.field("belief.min_resting_votes", c.min_resting_votes, {0, 2048}, "... so many features at their place");
  binder.field("belief.min_resting_ratio", c.min_resting_ratio, {1.0, 1000.0}, "... to displaced ones");
  binder.field("belief.min_used_probability", c.min_used_probability, {0.0, 1.0},
               "believed in so much, an object takes part in the quick pose");
}

void bind_fusion(ConfigBinder& binder, FusionConfig& c) {
  binder.field("fusion.remove_below", c.remove_below, {0.0, 1.0}, "features less probably static are removed");
  binder.field("fusion.min_static_features", c.min_static_features, {0, 2048}, "fewer: the best of the doubtful stay");
  binder.field("fusion.boost", c.boost, {1.0, 2.0}, "times as many features while something is masked");
}

void bind_published(ConfigBinder& binder, EpipolarConfig& epipolar, PaperConfig& paper) {
  binder.field("epipolar.max_corners", epipolar.max_corners, {50, 10000}, "mode epipolar: corners followed");
  binder.field("epipolar.max_distance_px", epipolar.max_distance_px, {0.1, 20.0},
               "mode epipolar: farther from its line: moving");
  binder.field("epipolar.max_still_points", epipolar.max_still_points, {0, 1000},
               "mode epipolar: more moving points: the person moves");
  binder.field("paper.tau_m", paper.tau_m, {0.01, 2.0}, "mode rtd-paper: depth difference of a mover");
  binder.field("paper.max_view_angle_deg", paper.max_view_angle_deg, {1.0, 90.0},
               "mode rtd-paper: no statement beyond");
  binder.field("paper.max_baseline_m", paper.max_baseline_m, {0.01, 10.0},
               "mode rtd-paper: keyframes not asked beyond");
  binder.field("paper.keyframes", paper.keyframes, {1, 16}, "mode rtd-paper: keyframes asked");
}

void bind_tracks(ConfigBinder& binder, BoxTrackConfig& c) {
  binder.field("tracks.detection_noise", c.noise.detection, {0.001, 1.0}, "of a detected edge, box sizes");
  binder.field("tracks.acceleration", c.noise.acceleration, {0.01, 100.0}, "of an object, box sizes / s^2");
  binder.field("tracks.flow_noise", c.noise.flow, {0.0001, 1.0}, "of a shift by optical flow, box sizes");
  binder.field("tracks.first_velocity", c.noise.first_velocity, {0.01, 100.0}, "of a box seen once, box sizes / s");
  binder.field("tracks.min_overlap", c.min_overlap, {0.0, 1.0}, "of a track and a detection, less: not the same");
  binder.field("tracks.max_match_cost", c.max_match_cost, {0.1, 2.0}, "1 - overlap, class and depth; more: another");
  binder.field("tracks.confirm_hits", c.confirm_hits, {1, 100}, "seen less often: ended by the first answer without");
  binder.field("tracks.survive_misses_s", c.survive_misses_s, {0.0, 60.0}, "before answers without it are believed");
  binder.field("tracks.silence_s", c.silence_s, {0.0, 60.0}, "without any answer it is carried so long");
  binder.field("tracks.fast_roll_deg_s", c.fast_roll_deg_s, {1.0, 1000.0}, "faster: answers without it do not count");
  binder.field("tracks.roll_patience_s", c.roll_patience_s, {0.0, 60.0}, "but not for longer than this");
  binder.field("tracks.unwatched_s", c.unwatched_s, {0.0, 60.0}, "nobody looks for so long: geometry only");
}

void bind_movers(ConfigBinder& binder, MoverTrackConfig& c) {
  binder.field("movers.confirm_hits", c.confirm_hits, {1, 100}, "seen moving less often: no mover yet");
  binder.field("movers.acceleration_m_s2", c.acceleration_m_s2, {0.01, 100.0}, "of a mover without a class");
  binder.field("movers.expect_after_s", c.expect_after_s, {0.0, 60.0}, "unseen so long: masked where it is expected");
  binder.field("movers.rest_s", c.rest_s, {0.0, 60.0}, "at rest so long: part of the world");
  binder.field("movers.gone_s", c.gone_s, {0.0, 60.0}, "its place seen without it so long: gone");
  binder.field("movers.max_unseen_s", c.max_unseen_s, {0.0, 60.0}, "unseen longer: it may be anywhere");
  binder.field("movers.max_unseen_way_m", c.max_unseen_way_m, {0.0, 10.0}, "the same for its way meanwhile");
}

}  // namespace

std::vector<std::string> mode_names() {
  std::vector<std::string> names;
  for (const ModeEntry& entry : all_modes()) names.emplace_back(entry.name);
  return names;
}

void ServiceConfig::bind(ConfigBinder& binder) {
  binder.choice("mode", mode, mode_names(), "which parts of the filter are at work");
  binder.choice("detector", detector, {"auto", "off"}, "auto: use a detector that is heard");
  binder.field("detections_timeout_ms", detections_timeout_ms, {1, 600000}, "asap, lockstep: longest wait for boxes");
  binder.field("feedback_timeout_ms", feedback_timeout_ms, {1, 600000}, "lockstep: longest wait for slam");
  bind_techniques(binder, core.techniques);
  bind_orb(binder, core.orb);
  bind_surfaces(binder, core.clusters, core.masks);
  bind_ego_motion(binder, core.ego_motion);
  bind_geometry(binder, core.geometry);
  bind_belief(binder, core.belief);
  bind_fusion(binder, core.fusion);
  bind_movers(binder, core.movers);
  bind_published(binder, core.epipolar, core.paper);
  bind_tracks(binder, core.tracks);
  binder.field("motion_levels", core.motion_levels, "class -> high, medium, low, none; over the built-in table");
}

FilterConfig ServiceConfig::core_config() const {
  FilterConfig config = core;
  for (const ModeEntry& entry : all_modes()) {
    if (mode == entry.name) config.mode = entry.mode;
  }
  try {
    const vision::MotionLevels check(config.motion_levels);
  } catch (const std::invalid_argument& error) {
    throw service::ConfigError(std::string("filter.motion_levels: ") + error.what());
  }
  return config;
}

}  // namespace rtd::filter
