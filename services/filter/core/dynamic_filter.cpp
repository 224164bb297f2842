// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/dynamic_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/msg/transform_eigen.hpp"
#include "services/filter/core/belief/log_odds.hpp"
#include "services/filter/core/belief/static_probability.hpp"
#include "services/filter/core/modes/mode_table.hpp"
#include "services/filter/core/motion/arrivals.hpp"
#include "services/filter/core/motion/slow_votes.hpp"
#include "services/filter/core/stage_clock.hpp"

namespace rtd::filter {

struct DynamicFilter::Scene {
  const vision::RgbdImage& image;
  DepthGrid grid;
  DepthClusters clusters;
  std::vector<std::uint8_t> may_move;  ///< per cell, 1 = on an object of a high level that is not known to rest
  std::vector<std::uint8_t> high;      ///< per cell, 1 = on an object of a high level, known to rest or not
  bool watched = false;                ///< somebody has looked for objects in this frame
};

struct DynamicFilter::Geometry {
  EgoMotion ego;
  DepthEvidence evidence;
  DynamicRegions regions;
};

namespace {

/// How far to look back for slow movers.
std::int64_t look_back_ns(std::uint64_t seq) {
  return seq % kFramesPerLookBack == 0 ? 1'500'000'000 : 0;
}

bool uses_geometry(FilterMode mode) {
  return mode == FilterMode::kGeometry || mode == FilterMode::kRtd;
}

/// Per feature: does it lie on one of these cells?
std::vector<char> on_cells(const std::vector<msg::Feature>& features, const GridShape& shape,
                           const std::vector<std::uint8_t>& cells) {
  std::vector<char> on(features.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    on[i] = cells[static_cast<std::size_t>(shape.nearest_cell(features[i].u_px, features[i].v_px))] != 0 ? 1 : 0;
  }
  return on;
}

CellMask united(CellMask a, const CellMask& b) {
  std::transform(a.begin(), a.end(), b.begin(), a.begin(), [](auto x, auto y) { return std::max(x, y); });
  return a;
}

/// Per feature: does it lie on the first of these areas that leaves at least half of the features, or else on `least`?
std::vector<char> first_that_leaves_half(const std::vector<msg::Feature>& features, const GridShape& shape,
                                         const std::vector<CellMask>& areas, const CellMask& least) {
  for (const CellMask& area : areas) {
    std::vector<char> on = on_cells(features, shape, area);
    if (2 * std::count(on.begin(), on.end(), 1) <= static_cast<std::ptrdiff_t>(on.size())) return on;
  }
  return on_cells(features, shape, least);
}

/// `spoken`: cells that are not dynamic were found to be at rest.
std::vector<CellMotion> cell_motion(const CellMask& dynamic, bool spoken) {
  std::vector<CellMotion> motion(dynamic.size());
  std::transform(dynamic.begin(), dynamic.end(), motion.begin(), [spoken](std::uint8_t moves) {
    return moves != 0 ? CellMotion::kDynamic : spoken ? CellMotion::kStatic : CellMotion::kUnknown;
  });
  return motion;
}

std::vector<int> clusters_of(const std::vector<msg::Feature>& features, const DepthClusters& clusters) {
  std::vector<int> of(features.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    of[i] = clusters.label[static_cast<std::size_t>(clusters.shape.nearest_cell(features[i].u_px, features[i].v_px))];
  }
  return of;
}

std::uint32_t count_removed(const std::vector<msg::Feature>& features) {
  return static_cast<std::uint32_t>(std::count_if(
      features.begin(), features.end(), [](const msg::Feature& f) { return (f.flags & msg::kFeatureRemoved) != 0; }));
}

}  // namespace

DetectorWord word_of(std::int64_t stamp_ns, const Detections& detections) {
  if (!detections) return {};
  return {true, {{stamp_ns, *detections}}};
}

/// The story of DESIGN section 4: what may move, where the camera is, what does move, how static each feature is.
FilterResult DynamicFilter::judge(const vision::RgbdImage& image, std::vector<msg::Feature> features,
                                  const DetectorWord& word) {
  FilterResult result;
  result.features = std::move(features);
  if (config_.mode != FilterMode::kOff) {
    StageClock clock(now_ns_);
    Scene scene = look_at(image);  // depth cells and surfaces
    result.stage_ms[msg::kStageMasks] = clock.lap_ms();
    find_what_may_move(word, scene, result);  // rules 1, 2, 5: motion levels, boxes to masks, tracks
    if (published_ != nullptr) {
      judge_as_published(scene, result);
    } else {
      const Geometry geometry = find_what_moves(scene, result);  // rule 3: quick pose, multi-view check
      weigh(scene, geometry, result);                            // rules 4 and 6: one probability, never starve
      remember(std::move(scene), geometry, result);
    }
  }
  result.stage_ms[msg::kStageExtract] = extract_ms_;
  result.stage_ms[msg::kStageFilterTotal] =
      std::accumulate(result.stage_ms.begin(), result.stage_ms.begin() + msg::kStageFilterTotal, 0.0F);
  return result;
}

DynamicFilter::DynamicFilter(const FilterConfig& config, std::function<std::int64_t()> now_ns)
    : config_(effective_config(config)),
      now_ns_(std::move(now_ns)),
      levels_(config_.techniques.motion_levels ? MotionLevels(config.motion_levels)
                                               : MotionLevels(config.motion_levels).all_high()),
      extractor_(config.orb),
      sampler_(config.orb.min_depth_m, config.orb.max_depth_m),
      movers_(config_.movers),
      follower_(config_),
      published_(make_published_mode(config_)) {}

std::vector<msg::Feature> DynamicFilter::extract(const vision::RgbdImage& image) {
  StageClock clock(now_ns_);
  const bool more = something_masked_ && config_.mode != FilterMode::kOff;
  const double wanted = config_.orb.feature_count * (more ? config_.fusion.boost : 1.0);
  std::vector<msg::Feature> features = extractor_.extract(image, static_cast<int>(std::lround(wanted)));
  extract_ms_ = clock.lap_ms();
  return features;
}

DynamicFilter::Scene DynamicFilter::look_at(const vision::RgbdImage& image) {
  DepthGrid grid = sampler_.sample(image);
  DepthClusters clusters = find_depth_clusters(grid, config_.clusters);
  const auto cells = static_cast<std::size_t>(grid.shape.size());
  return {image,
          std::move(grid),
          std::move(clusters),
          std::vector<std::uint8_t>(cells, 0),
          std::vector<std::uint8_t>(cells, 0),
          false};
}

void DynamicFilter::find_what_may_move(const DetectorWord& word, Scene& scene, FilterResult& result) {
  if (!looks_at_boxes(config_.mode)) return;
  StageClock clock(now_ns_);
  scene.watched = word.watching;
  const std::vector<ObjectBox> boxes = follower_.follow(word, scene.image, scene.grid, views_);
  result.objects = find_objects(boxes, levels_, scene.image.camera, scene.grid, scene.clusters, config_.masks);
  follower_.learn_depths(result.objects, scene.grid);
  for (const SceneObject& object : result.objects) {
    if (object.level != MotionLevel::kHigh || object.flat) continue;
    for (const int cell : object.cells) scene.may_move[static_cast<std::size_t>(cell)] = 1;
  }
  scene.high = dilate(scene.grid.shape, scene.may_move, config_.masks.dilate_cells);
  scene.clusters = separate_objects(std::move(scene.clusters), result.objects);
  trust_known_surfaces(scene);
  scene.may_move = dilate(scene.grid.shape, scene.may_move, config_.masks.dilate_cells);
  result.stage_ms[msg::kStageMasks] += clock.lap_ms();
}

CellBeliefs DynamicFilter::recall_beliefs(const Scene& scene, const Eigen::Isometry3d& T_world_camera) const {
  if (views_.empty()) return CellBeliefs(scene.may_move.size(), kNoBelief);
  return beliefs_.recall(scene.grid, sampler_.rays(), scene.image.camera,
                         views_.newest().T_world_camera.inverse() * T_world_camera);
}

/// What has been seen at rest for long takes part in the pose and in later checks, whatever its class.
void DynamicFilter::trust_known_surfaces(Scene& scene) const {
  if (views_.empty() || !config_.techniques.belief || !config_.techniques.resting_objects) return;
  if (std::none_of(scene.may_move.begin(), scene.may_move.end(), [](int cell) { return cell != 0; })) return;
  const CellBeliefs beliefs = recall_beliefs(scene, views_.predict_pose());
  const float enough = log_odds(config_.belief.min_used_probability);
  for (std::size_t cell = 0; cell < beliefs.size(); ++cell) {
    if (is_known(beliefs[cell]) && beliefs[cell] >= enough) scene.may_move[cell] = 0;
  }
}

/// Per cell: for how many frames it is still believed to move by what was seen before; 0 = not.
CellMask DynamicFilter::recall_movers(const Scene& scene, const Eigen::Isometry3d& T_world_camera) const {
  constexpr std::uint8_t kExpectedFrames = 3;
  CellMask remembered =
      memory_.recall(scene.grid, scene.image.camera, T_world_camera.inverse() * views_.newest().T_world_camera);
  if (!config_.techniques.mover_tracks) return remembered;
  const CellMask expected =
      movers_.expected({scene.grid, sampler_.rays(), scene.image.camera, {scene.image.stamp_ns, T_world_camera}});
  for (std::size_t cell = 0; cell < expected.size(); ++cell) {
    if (expected[cell] != 0 && scene.high[cell] == 0) remembered[cell] = std::max(remembered[cell], kExpectedFrames);
  }
  return remembered;
}

/// Surfaces that were seen moving in this very frame, but those with a class of a high level: they have box tracks.
void DynamicFilter::follow_movers(const Scene& scene, const Geometry& geometry, FilterResult& result) {
  if (!config_.techniques.mover_tracks || !geometry.regions.trusted) return;
  const int fresh = config_.geometry.memory_frames;
  CellMask moving(geometry.regions.frames_left);
  for (std::size_t cell = 0; cell < moving.size(); ++cell)
    moving[cell] = moving[cell] == fresh && scene.high[cell] == 0 ? 1 : 0;
  movers_.update({scene.grid, sampler_.rays(), scene.image.camera, {scene.image.stamp_ns, result.T_world_camera}},
                 scene.clusters, moving, geometry.ego.slow_votes);
  result.movers = movers_.movers();
}

DynamicFilter::Geometry DynamicFilter::find_what_moves(const Scene& scene, FilterResult& result) {
  const auto cells = static_cast<std::size_t>(scene.grid.shape.size());
  const std::vector<std::uint8_t> nothing(cells, 0);
  Geometry geometry{{}, DepthEvidence::none(cells), {false, nothing, 0}};
  if (views_.empty() || !uses_geometry(config_.mode)) return geometry;

  StageClock clock(now_ns_);
  const Eigen::Isometry3d T_world_predicted = views_.predict_pose();
  CellMask avoid = united(dilate(scene.grid.shape, recall_movers(scene, T_world_predicted), 1), scene.may_move);

  if (!views_.spans(scene.image.stamp_ns, kMinSettledAgeNs)) {  // too early to tell movers from the camera's motion
    avoid = united(std::move(avoid), free_standing(scene.grid, scene.clusters, config_.masks));
  }
  const auto& p = scene.image.camera.parameters();
  const vision::FeatureGrid feature_grid(result.features, p.width, p.height);
  // People at rest too, so that one who rises does not take the pose along; but neither they nor memory may blind us.
  const std::vector<char> excluded =
      first_that_leaves_half(result.features, scene.grid.shape, {united(avoid, scene.high), avoid}, scene.may_move);
  const std::vector<int> cluster_of = clusters_of(result.features, scene.clusters);
  const EgoMotionInput input{{result.features, feature_grid, scene.image.camera},
                             excluded,
                             cluster_of,
                             scene.clusters,
                             views_,
                             scene.image.stamp_ns,
                             T_world_predicted,
                             look_back_ns(scene.image.seq)};
  geometry.ego = estimate_ego_motion(input, config_.ego_motion, config_.geometry);
  // Who has a class of a high level has his own rules (belief): a second later he may have stopped again.
  geometry.ego.slow_votes = without_votes_on(scene.may_move, std::move(geometry.ego.slow_votes), scene.clusters);
  result.T_world_camera = geometry.ego.T_world_camera;
  result.pose_reliable = geometry.ego.reliable;
  result.stage_ms[msg::kStageEgoMotion] = clock.lap_ms();
  const CellMask remembered = recall_movers(scene, geometry.ego.T_world_camera);
  if (geometry.ego.reliable) {
    const auto views =
        views_.references(scene.image.stamp_ns, geometry.ego.T_world_camera,
                          {static_cast<std::size_t>(config_.geometry.max_views), config_.geometry.max_baseline_m});
    geometry.evidence = check_depth(scene.grid, sampler_.rays(), {scene.image.stamp_ns, geometry.ego.T_world_camera},
                                    views, scene.image.camera, config_.geometry);
    geometry.evidence = accept_arrivals(std::move(geometry.evidence), scene.clusters, geometry.ego.votes,
                                        geometry.ego.old_votes, config_.geometry);
  }
  geometry.regions = find_dynamic_regions(scene.clusters, geometry.evidence,
                                          {geometry.ego.votes, geometry.ego.slow_votes}, remembered, config_.geometry);
  geometry.regions.trusted = geometry.regions.trusted && geometry.ego.reliable;
  follow_movers(scene, geometry, result);
  result.dynamic_clusters = static_cast<std::uint32_t>(geometry.regions.clusters);
  result.stage_ms[msg::kStageDepthCheck] = clock.lap_ms();
  return geometry;
}

void DynamicFilter::weigh(const Scene& scene, const Geometry& geometry, FilterResult& result) {
  StageClock clock(now_ns_);
  const MotionEvidence evidence{geometry.regions, geometry.evidence, geometry.ego.votes};
  const std::vector<std::int16_t> object_on = objects_on_cells(scene.grid.shape, result.objects);
  const std::vector<ObjectMotion> motions = judge_objects(result.objects, evidence, config_.belief);
  const double elapsed_s =
      views_.empty() ? 0.0 : 1e-9 * static_cast<double>(scene.image.stamp_ns - views_.newest().stamp_ns);
  CellBeliefs beliefs =
      update_beliefs(recall_beliefs(scene, result.T_world_camera),
                     {result.objects, motions, object_on, evidence, elapsed_s}, config_.belief, config_.techniques);
  const FrameKnowledge known{scene.grid.shape, result.objects, object_on, beliefs, geometry.regions, geometry.evidence};
  weigh_static_probability(result.features, known, config_);
  beliefs_.store(scene.grid, std::move(beliefs));
  result.removed = count_removed(result.features);
  result.stage_ms[msg::kStageFuse] = clock.lap_ms();
}

void DynamicFilter::judge_as_published(const Scene& scene, FilterResult& result) {
  StageClock clock(now_ns_);
  const PublishedVerdict verdict = published_->judge({scene.image, scene.grid.shape, result.objects}, result.features);
  result.T_world_camera = verdict.T_world_camera;
  result.pose_reliable = verdict.pose_reliable;
  result.cells = scene.grid.shape;
  result.motion = cell_motion(verdict.removed, false);
  result.removed = count_removed(result.features);
  result.stage_ms[msg::kStageDepthCheck] = clock.lap_ms();
}

void DynamicFilter::remember(Scene scene, const Geometry& geometry, FilterResult& result) {
  something_masked_ = result.removed > 0;
  memory_.store(scene.grid, sampler_.rays(), geometry.regions.frames_left);
  View view;
  view.seq = scene.image.seq;
  view.stamp_ns = scene.image.stamp_ns;
  view.T_world_camera = result.T_world_camera;
  view.settled = views_.empty() || geometry.ego.settled;
  view.dynamic =
      united(dilate(scene.grid.shape, geometry.regions.frames_left, config_.masks.dilate_cells), scene.may_move);
  result.cells = scene.grid.shape;
  result.motion = cell_motion(view.dynamic, uses_geometry(config_.mode) ? geometry.regions.trusted : scene.watched);
  view.grid = std::move(scene.grid);
  view.features = result.features;
  views_.add(std::move(view));
}

void DynamicFilter::on_tracking(const msg::TrackingResult& result) {
  if (result.state != msg::TrackingState::kOk) return;
  if (std::exchange(map_, result.map_id) != result.map_id) {  // poses of two maps have nothing to do with each other
    views_.forget_before(result.seq);
    movers_.clear();
  }
  if (!views_.correct(result.seq, msg::to_isometry(result.T_world_camera))) movers_.clear();  // another world
  if (published_ != nullptr) published_->on_tracking(result.seq, msg::to_isometry(result.T_world_camera));
}

void DynamicFilter::on_keyframe(const msg::KeyframeEvent& event) {
  if (event.kind == msg::KeyframeEventKind::kRemoved) {
    views_.forget_keyframe(event.frame_seq);
    if (published_ != nullptr) published_->forget_keyframe(event.frame_seq);
  } else {
    if (!views_.mark_keyframe(event.frame_seq, msg::to_isometry(event.T_world_camera))) movers_.clear();
    if (published_ != nullptr) published_->on_keyframe(event.frame_seq, msg::to_isometry(event.T_world_camera));
  }
}

void DynamicFilter::reset() {
  views_.clear();
  memory_.clear();
  movers_.clear();
  beliefs_.clear();
  follower_.clear();
  if (published_ != nullptr) published_->reset();
  something_masked_ = true;
}

}  // namespace rtd::filter
