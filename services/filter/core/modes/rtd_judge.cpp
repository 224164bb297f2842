// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/modes/rtd_judge.hpp"

#include <algorithm>
#include <utility>

#include "common/msg/stamps.hpp"
#include "services/filter/core/belief/static_probability.hpp"

namespace rtd::filter {
namespace {

/// Surfaces at least this probably static take part in the quick pose, whatever their class.
constexpr double kMinUsedProbability = 0.5;

constexpr std::int64_t kCentisecondNs = 10'000'000;
constexpr double kKnownToRest = 0.98;  // belief of a surface whose memory of motion came from a neighbour
constexpr int kBesidePeopleCells = 8;
constexpr std::int64_t kQuestionsNs = 500'000'000;  // of views, from which on everything is judged by them

/// How far to look back for slow movers; 0 = not in this frame.
std::int64_t look_back_ns(std::int64_t last_ns, std::int64_t now_ns) {
  return now_ns / kLookBackEveryNs != last_ns / kLookBackEveryNs ? 1'500'000'000 : 0;
}

MoverFrame mover_frame(const Scene& scene, const Eigen::Isometry3d& T_world_camera) {
  return {scene.surfaces.grid, scene.surfaces.rays, scene.image.camera, {scene.image.stamp_ns, T_world_camera}};
}

/// Per feature: does it lie on one of these cells?
std::vector<char> features_on(const CellMask& cells, const std::vector<msg::Feature>& features,
                              const GridShape& shape) {
  std::vector<char> on(features.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    on[i] = cells[static_cast<std::size_t>(shape.nearest_cell(features[i].u_px, features[i].v_px))] != 0 ? 1 : 0;
  }
  return on;
}

bool any(const std::vector<char>& flags) {
  return std::find(flags.begin(), flags.end(), 1) != flags.end();
}

/// Per feature: does it lie on the first of these areas that leaves at least half of the features, or else on `least`?
std::vector<char> first_that_leaves_half(const std::vector<msg::Feature>& features, const GridShape& shape,
                                         const std::vector<CellMask>& areas, const CellMask& least) {
  for (const CellMask& area : areas) {
    std::vector<char> on = features_on(area, features, shape);
    if (2 * std::count(on.begin(), on.end(), 1) <= static_cast<std::ptrdiff_t>(on.size())) return on;
  }
  return features_on(least, features, shape);
}

std::vector<int> clusters_of(const std::vector<msg::Feature>& features, const DepthClusters& clusters) {
  std::vector<int> of(features.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    of[i] = clusters.label[static_cast<std::size_t>(clusters.shape.nearest_cell(features[i].u_px, features[i].v_px))];
  }
  return of;
}

}  // namespace

/// How dynamic points are found: where the camera is, what moves, how probably each feature is static.
Verdict RtdJudge::judge(const Scene& scene, std::vector<msg::Feature> features, StageClock& clock) {
  const Foreground foreground = separate_foreground(scene);                   // what may move, by its class
  UndecidedSurfaces undecided = find_undecided(scene, foreground, features);  // what may be carried, after a start
  clock.finish(msg::kStageMasks);
  const EgoMotion ego = find_ego_motion(scene, foreground, features, undecided);
  clock.finish(msg::kStageEgoMotion);
  const DepthEvidence evidence = compare_with_views(scene, foreground, ego);  // the multi-view check
  const DynamicRegions regions = find_regions(scene, foreground, undecided, ego, evidence);
  std::vector<TrackedMover> movers = follow_movers(scene, foreground, ego, regions);
  clock.finish(msg::kStageDepthCheck);
  features = weigh(scene, {undecided.open, regions, evidence, ego}, std::move(features));  // to one probability
  clock.finish(msg::kStageFuse);
  const CellMask dynamic = dynamic_cells(scene, foreground, regions);
  remember(scene, ego, regions, dynamic, features);
  const bool others_rest = uses_geometry() ? regions.trusted : scene.detector_active;
  return {.features = std::move(features),
          .motion = to_cell_motion(dynamic, others_rest),
          .T_world_camera = ego.T_world_camera,
          .pose_reliable = ego.reliable,
          .dynamic_clusters = static_cast<std::uint32_t>(regions.clusters),
          .movers = std::move(movers)};
}

RtdJudge::Foreground RtdJudge::separate_foreground(const Scene& scene) const {
  const int grow_cells = config_.masks.dilate_cells;
  CellMask on_high(static_cast<std::size_t>(scene.shape().size()), 0);
  for (const SceneObject& object : scene.objects) {
    if (object.level != MotionLevel::kHigh || object.flat) continue;
    for_each_covered_cell(object, [&](std::size_t cell) { on_high[cell] = 1; });
  }
  return {separate_objects(scene.surfaces.clusters, scene.objects), dilate(scene.shape(), on_high, grow_cells),
          dilate(scene.shape(), without_known_surfaces(scene, on_high), grow_cells)};
}

/// What has been seen at rest for long takes part in the pose and in later checks, whatever its class.
CellMask RtdJudge::without_known_surfaces(const Scene& scene, CellMask may_move) const {
  if (views_.empty() || !config_.techniques.belief || !config_.techniques.resting_objects) return may_move;
  if (std::none_of(may_move.begin(), may_move.end(), [](int cell) { return cell != 0; })) return may_move;
  const CellBeliefs beliefs = recall_beliefs(scene, predict_pose(scene));
  const float enough = log_odds(kMinUsedProbability);
  for (std::size_t cell = 0; cell < beliefs.size(); ++cell) {
    if (is_known(beliefs[cell]) && beliefs[cell] >= enough) may_move[cell] = 0;
  }
  return may_move;
}

/// Constant velocity, turned as the gyroscope says where there is one.
Eigen::Isometry3d RtdJudge::predict_pose(const Scene& scene) const {
  Eigen::Isometry3d T_world_camera = views_.predict_pose(scene.image.stamp_ns);
  if (scene.gyroscope == nullptr) return T_world_camera;
  const View& newest = views_.newest();
  if (const auto turn = scene.gyroscope->turn(newest.stamp_ns, scene.image.stamp_ns))
    T_world_camera.linear() = newest.T_world_camera.linear() * turn->R_earlier_later;
  return T_world_camera;
}

CellBeliefs RtdJudge::recall_beliefs(const Scene& scene, const Eigen::Isometry3d& T_world_camera,
                                     const CellMask* where) const {
  if (views_.empty()) return CellBeliefs(static_cast<std::size_t>(scene.shape().size()), kNoBelief);
  return beliefs_.recall(scene.surfaces.grid, scene.surfaces.rays, scene.image.camera,
                         views_.newest().T_world_camera.inverse() * T_world_camera, where);
}

/// Memory spreads where surfaces are divided in another way than before: what has rested for long does not take part.
/// People and what they touch do: the chair of a person who gets up is judged with its person.
void RtdJudge::forget_what_is_known_to_rest(const Scene& scene, const Foreground& foreground,
                                            const Eigen::Isometry3d& T_world_camera, CellMask& hold_cs) const {
  const bool remembers = std::any_of(hold_cs.begin(), hold_cs.end(), [](int cs) { return cs != 0; });
  if (!remembers || !config_.techniques.belief) return;
  const CellBeliefs beliefs = recall_beliefs(scene, T_world_camera, &hold_cs);
  const float known = log_odds(kKnownToRest);
  const CellMask beside_people = dilate(scene.shape(), foreground.high, kBesidePeopleCells);
  for (std::size_t cell = 0; cell < beliefs.size(); ++cell) {
    if (is_known(beliefs[cell]) && beliefs[cell] >= known && beside_people[cell] == 0) hold_cs[cell] = 0;
  }
}

/// Per cell: for how long it counts as moving because of earlier frames; 0 = it does not.
RememberedMotion RtdJudge::recall_movers(const Scene& scene, const Foreground& foreground,
                                         const Eigen::Isometry3d& T_world_camera) const {
  constexpr int kExpectedCs = 7;  // after this frame
  const View& newest = views_.newest();
  RememberedMotion remembered;
  remembered.elapsed_cs = static_cast<int>(
      std::clamp<std::int64_t>(scene.image.stamp_ns / kCentisecondNs - newest.stamp_ns / kCentisecondNs, 1, 255));
  remembered.hold_cs =
      memory_.recall(scene.surfaces.grid, scene.image.camera, T_world_camera.inverse() * newest.T_world_camera,
                     msg::minus_s(scene.image.stamp_ns, newest.stamp_ns));
  forget_what_is_known_to_rest(scene, foreground, T_world_camera, remembered.hold_cs);
  if (!config_.techniques.mover_tracks) return remembered;
  const auto expected_cs = static_cast<std::uint8_t>(std::min(255, kExpectedCs + remembered.elapsed_cs));
  const CellMask expected = movers_.expected(mover_frame(scene, T_world_camera));
  for (std::size_t cell = 0; cell < expected.size(); ++cell) {
    if (expected[cell] == 0 || foreground.high[cell] != 0) continue;
    remembered.hold_cs[cell] = std::max(remembered.hold_cs[cell], expected_cs);
  }
  return remembered;
}

/// People are left to their class, movers to the memory of them.
UndecidedSurfaces RtdJudge::find_undecided(const Scene& scene, const Foreground& foreground,
                                           const std::vector<msg::Feature>& features) {
  const bool asks = uses_geometry() && config_.techniques.feature_votes;
  if (!asks || views_.spans(scene.image.stamp_ns, kQuestionsNs))
    return {CellMask(foreground.high.size(), 0), CellMask(foreground.high.size(), 0)};
  CellMask excluded = united(foreground.may_move, foreground.high);
  if (!views_.empty()) {
    const Eigen::Isometry3d T_world_predicted = predict_pose(scene);
    excluded = united(std::move(excluded), recall_movers(scene, foreground, T_world_predicted).hold_cs);
    decisions_.recall(scene.surfaces.grid, scene.image.camera,
                      T_world_predicted.inverse() * views_.newest().T_world_camera,
                      msg::minus_s(scene.image.stamp_ns, views_.newest().stamp_ns));
  }
  return decisions_.find({scene.surfaces.grid, scene.surfaces.rays, foreground.clusters, features}, excluded,
                         config_.masks.min_outline_step_m);
}

EgoMotion RtdJudge::find_ego_motion(const Scene& scene, const Foreground& foreground,
                                    const std::vector<msg::Feature>& features, UndecidedSurfaces& undecided) {
  if (!compares()) return {};
  const GridShape& shape = scene.shape();
  const Eigen::Isometry3d T_world_predicted = predict_pose(scene);
  const CellMask avoid =
      united(dilate(shape, recall_movers(scene, foreground, T_world_predicted).hold_cs, 1), foreground.may_move);
  const auto& p = scene.image.camera.parameters();
  const vision::FeatureGrid feature_grid(features, p.width, p.height);
  // People at rest are left out too, so that one who rises does not take the pose along. But neither people nor memory
  // may leave too few features.
  std::vector<char> excluded =
      first_that_leaves_half(features, shape, {united(avoid, foreground.high), avoid}, foreground.may_move);
  const std::vector<int> cluster_of = clusters_of(features, foreground.clusters);
  const EgoMotionInput input{{features, feature_grid, scene.image.camera},
                             excluded,
                             cluster_of,
                             foreground.clusters,
                             views_,
                             scene.image.stamp_ns,
                             T_world_predicted,
                             look_back_ns(views_.newest().stamp_ns, scene.image.stamp_ns),
                             scene.gyroscope};
  if (const std::vector<char> in_question = features_on(undecided.open, features, shape); any(in_question)) {
    decisions_.update(undecided, foreground.clusters, vote_on_surfaces(input, in_question, config_.ego_motion));
    const CellMask doubted = dilate(shape, united(undecided.open, undecided.moving), 1);
    const std::vector<char> on_doubted = features_on(doubted, features, shape);
    for (std::size_t i = 0; i < excluded.size(); ++i) excluded[i] = std::max(excluded[i], on_doubted[i]);
  }
  EgoMotion ego = estimate_ego_motion(input, config_.ego_motion, config_.geometry);
  // Objects of a high level have their own rule (belief): a second later they may have stopped again.
  ego.slow_votes = without_votes_on(foreground.may_move, std::move(ego.slow_votes), foreground.clusters);
  return ego;
}

DepthEvidence RtdJudge::compare_with_views(const Scene& scene, const Foreground& foreground,
                                           const EgoMotion& ego) const {
  if (!ego.reliable) return DepthEvidence::none(static_cast<std::size_t>(scene.shape().size()));
  const CameraPose pose{scene.image.stamp_ns, ego.T_world_camera};
  const auto references =
      views_.references(pose.stamp_ns, pose.T_world_camera,
                        {static_cast<std::size_t>(config_.geometry.max_views), config_.geometry.max_baseline_m});
  return accept_arrivals(
      check_depth(scene.surfaces.grid, scene.surfaces.rays, pose, references, scene.image.camera, config_.geometry),
      foreground.clusters, ego.votes, ego.old_votes, config_.geometry);
}

/// Features of what is in question have their own votes, which know how uncertain the pose without it is. Its depth
/// is compared as that of everything else.
DynamicRegions RtdJudge::find_regions(const Scene& scene, const Foreground& foreground,
                                      const UndecidedSurfaces& undecided, const EgoMotion& ego,
                                      const DepthEvidence& evidence) const {
  if (!compares()) return {false, CellMask(static_cast<std::size_t>(scene.shape().size()), 0), 0};
  const FeatureVotes quick = without_votes_on(undecided.open, ego.votes, foreground.clusters);
  const FeatureVotes slow = without_votes_on(undecided.open, ego.slow_votes, foreground.clusters);
  DynamicRegions regions = find_dynamic_regions(foreground.clusters, evidence, {quick, slow},
                                                recall_movers(scene, foreground, ego.T_world_camera), config_.geometry);
  regions.trusted = regions.trusted && ego.reliable;
  for (std::size_t cell = 0; cell < regions.hold_cs.size(); ++cell) {
    if (undecided.moving[cell] != 0) regions.hold_cs[cell] = to_cs(config_.geometry.memory_s);
  }
  return regions;
}

/// Tracks surfaces that move in this very frame. Those of a high level have box tracks instead.
std::vector<TrackedMover> RtdJudge::follow_movers(const Scene& scene, const Foreground& foreground,
                                                  const EgoMotion& ego, const DynamicRegions& regions) {
  if (!config_.techniques.mover_tracks || !regions.trusted) return {};
  CellMask moving(regions.hold_cs);
  const std::uint8_t longest_cs = to_cs(config_.geometry.memory_s);  // seen in this very frame
  for (std::size_t cell = 0; cell < moving.size(); ++cell)
    moving[cell] = moving[cell] == longest_cs && foreground.high[cell] == 0 ? 1 : 0;
  movers_.update(mover_frame(scene, ego.T_world_camera), foreground.clusters, moving, ego.slow_votes);
  return movers_.movers();
}

std::vector<msg::Feature> RtdJudge::weigh(const Scene& scene, const Findings& found,
                                          std::vector<msg::Feature> features) {
  const MotionEvidence motion{found.regions, found.evidence, found.ego.votes};
  const std::vector<std::int16_t> object_on = objects_on_cells(scene.shape(), scene.objects);
  const std::vector<ObjectMotion> motions = judge_objects(scene.objects, motion, config_.belief);
  const double elapsed_s = views_.empty() ? 0.0 : msg::minus_s(scene.image.stamp_ns, views_.newest().stamp_ns);
  CellBeliefs beliefs =
      update_beliefs(recall_beliefs(scene, found.ego.T_world_camera),
                     {scene.objects, motions, object_on, motion, elapsed_s}, config_.belief, config_.techniques);
  features = weigh_static_probability(
      std::move(features),
      {scene.shape(), scene.objects, object_on, beliefs, found.regions, found.evidence, found.in_question}, config_);
  for (std::size_t cell = 0; cell < beliefs.size(); ++cell) {
    if (found.in_question[cell] != 0) beliefs[cell] = kNoBelief;  // nothing was learnt about it
  }
  beliefs_.store(scene.surfaces.grid, std::move(beliefs));
  decisions_.store(scene.surfaces.grid, scene.surfaces.rays);
  return features;
}

void RtdJudge::remember(const Scene& scene, const EgoMotion& ego, const DynamicRegions& regions,
                        const CellMask& dynamic, const std::vector<msg::Feature>& features) {
  memory_.store(scene.surfaces.grid, scene.surfaces.rays, regions.hold_cs);
  View view;
  view.seq = scene.image.seq;
  view.stamp_ns = scene.image.stamp_ns;
  view.T_world_camera = ego.T_world_camera;
  view.settled = views_.empty() || ego.settled;
  view.dynamic = dynamic;
  view.grid = scene.surfaces.grid;
  view.features = features;
  views_.add(std::move(view));
}

void RtdJudge::on_pose(const SlamPose& pose) {
  if (std::exchange(map_, pose.map_id) != pose.map_id) {  // poses of two maps cannot be compared
    views_.forget_before(pose.seq);
    movers_.clear();
  }
  if (!views_.correct(pose.seq, pose.T_world_camera)) movers_.clear();  // another world
}

void RtdJudge::on_keyframe(const SlamKeyframe& keyframe) {
  if (keyframe.removed) {
    views_.forget_keyframe(keyframe.seq);
  } else if (!views_.mark_keyframe(keyframe.seq, keyframe.T_world_camera)) {
    movers_.clear();
  }
}

void RtdJudge::set_coarse(bool coarse) {
  config_ = configured_;
  if (!coarse) return;
  config_.geometry.max_views = std::min(config_.geometry.max_views, 3);
  config_.ego_motion.max_proposals = std::min(config_.ego_motion.max_proposals, 2);
  config_.ego_motion.max_observations = std::min(config_.ego_motion.max_observations, 200);
}

void RtdJudge::reset() {
  ModeJudge::reset();
  memory_.clear();
  movers_.clear();
  beliefs_.clear();
  decisions_.clear();
}

}  // namespace rtd::filter
