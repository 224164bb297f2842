// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/mapping/mapper.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/se3.hpp"
#include "common/msg/stamps.hpp"
#include "services/slam/core/mapping/mapping_steps.hpp"
#include "services/slam/core/place/vocabulary.hpp"

namespace rtd::slam {
namespace {

std::shared_ptr<const Vocabulary> choose_vocabulary(const SlamConfig& config) {
  if (!config.techniques.place_recognition) return nullptr;
  return config.place.vocabulary != nullptr ? config.place.vocabulary : built_in_vocabulary();
}

}  // namespace

Mapper::Mapper(const SlamConfig& config)
    : config_(config),
      vocabulary_(choose_vocabulary(config)),
      loop_closer_(config),
      adjuster_(GlobalBundleOptions{config.loop.global_iterations, 1, {}}) {}

void Mapper::restore(MapContents contents) {
  map_ = Map(std::move(contents));
  if (vocabulary_ == nullptr) return;
  for (const auto& [id, keyframe] : map_.keyframes()) places_.add(id, vocabulary_->describe(keyframe.frame->features));
}

KeyframeId Mapper::insert(const KeyframeProposal& proposal, const std::function<bool()>& interrupted) {
  const auto busy = [&] { return interrupted && interrupted(); };
  apply_adjustment();
  count_statistics(proposal.statistics);
  const KeyframeId keyframe = add_keyframe(proposal);
  recent_.cull(map_, keyframe, config_.mapper.min_found_ratio);
  create_landmarks(keyframe);
  if (!busy()) fuse_landmarks(map_, keyframe, config_.mapper.neighbours);
  confirm_witnesses(keyframe);
  std::vector<KeyframeId> adjusted;
  if (!busy() && due_for_adjustment(keyframe)) {
    adjusted = adjust_local_map(map_, keyframe, config_.mapper, interrupted);
    adjusted_ns_ = map_.find_keyframe(keyframe)->frame->stamp_ns;
  }
  cull_keyframes(keyframe);
  if (vocabulary_ != nullptr) places_.add(keyframe, vocabulary_->describe(proposal.frame->features));
  close_loop(keyframe);
  const Keyframe& created = *map_.find_keyframe(keyframe);
  announced_[keyframe] = created.T_world_camera;
  changes_.push_back(
      {KeyframeChange::Kind::kCreated, keyframe, created.frame->seq, created.frame->stamp_ns, created.T_world_camera});
  note_moved_keyframes(std::move(adjusted));
  return keyframe;
}

bool Mapper::due_for_adjustment(KeyframeId newest) const {
  constexpr std::size_t kYoung = 10;  // keyframes of a map that is adjusted each time
  const Keyframe& keyframe = *map_.find_keyframe(newest);
  const std::size_t keyframes = map_.keyframe_count(keyframe.map);
  if (keyframes <= 2) return false;
  const double since_s = std::abs(msg::minus_s(keyframe.frame->stamp_ns, adjusted_ns_));
  return keyframes < kYoung || since_s >= config_.mapper.ba_gap_s;
}

KeyframeId Mapper::add_keyframe(const KeyframeProposal& proposal) {
  const bool first = proposal.reference == kNoKeyframe;
  const Eigen::Isometry3d T_world_camera =
      first ? proposal.T_reference_camera : map_.T_world_keyframe(proposal.reference) * proposal.T_reference_camera;
  const KeyframeId parent = first ? kNoKeyframe : map_.living_ancestor(proposal.reference).first;
  const KeyframeId id = map_.add_keyframe(proposal.frame, geometry::normalized(T_world_camera), parent);
  map_.find_keyframe(id)->covariance = proposal.covariance;
  map_.find_keyframe(id)->carried = proposal.carried;
  map_.find_keyframe(id)->probation_weight = proposal.probation_weight;
  for (std::uint32_t feature = 0; feature < proposal.landmarks.size(); ++feature) {
    const LandmarkId landmark = proposal.landmarks[feature];
    if (landmark == kNoLandmark || map_.find_landmark(landmark) == nullptr) continue;
    if (map_.add_observation(landmark, {id, feature})) map_.refresh_landmark(landmark);
  }
  return id;
}

/// A keyframe that witnesses did not carry makes none: what it sees may be what it follows.
void Mapper::confirm_witnesses(KeyframeId id) {
  const Keyframe& keyframe = *map_.find_keyframe(id);
  if (!keyframe.carried) return;
  const std::int64_t now_ns = keyframe.frame->stamp_ns;
  for (const LandmarkId landmark_id : keyframe.landmarks) {
    if (landmark_id == kNoLandmark) continue;
    Landmark& landmark = *map_.find_landmark(landmark_id);
    if (landmark.witness) continue;
    if (landmark.carried_since_ns == 0) landmark.carried_since_ns = now_ns;
    landmark.witness = msg::minus_s(now_ns, landmark.carried_since_ns) >= config_.witness.after_s;
  }
}

void Mapper::count_statistics(const std::vector<LandmarkStatistics>& statistics) {
  for (const LandmarkStatistics& entry : statistics) {
    Landmark* landmark = map_.find_landmark(entry.landmark);
    if (landmark == nullptr) continue;
    landmark->visible += entry.visible;
    landmark->found += entry.found;
  }
}

void Mapper::create_landmarks(KeyframeId keyframe) {
  // The first keyframe of a map has nothing but its depth: all of it is used.
  const bool first = map_.find_keyframe(keyframe)->is_origin();
  recent_.add(create_from_depth(map_, keyframe, first ? config_.sensor.max_depth_m : config_.sensor.close_depth_m));
  recent_.add(create_by_triangulation(map_, keyframe, config_.mapper.neighbours, config_.sensor.close_depth_m));
  if (config_.techniques.beyond_range) recent_.add(create_beyond_range(map_, keyframe));
}

void Mapper::cull_keyframes(KeyframeId newest) {
  const std::int64_t now_ns = map_.find_keyframe(newest)->frame->stamp_ns;
  for (const KeyframeId id : map_.best_covisible(newest, kMaxRedundancyCandidates)) {
    if (!is_redundant_keyframe(map_, id, now_ns, config_.mapper)) continue;
    const Keyframe& keyframe = *map_.find_keyframe(id);
    if (announced_.erase(id) > 0) {
      changes_.push_back(
          {KeyframeChange::Kind::kRemoved, id, keyframe.frame->seq, keyframe.frame->stamp_ns, keyframe.T_world_camera});
    }
    places_.remove(id);
    map_.remove_keyframe(id);
  }
}

/// docs/theory/loop_closing.md.
void Mapper::close_loop(KeyframeId newest) {
  if (!config_.techniques.loop_closing || vocabulary_ == nullptr) return;
  const std::optional<LoopClosure> closure = loop_closer_.close(map_, places_, newest);
  if (!closure) return;
  loops_.push_back(*closure);
  spread_certainty(map_, closure->edge.older, closure->edge.newer);
  note_all_moved_keyframes();
  if (config_.loop.global_iterations == 0) return;
  adjuster_.start(copy_global_problem(map_, closure->map));
  apply_adjustment();
}

void Mapper::apply_adjustment() {
  const std::optional<GlobalProblem> adjusted = adjuster_.take();
  if (!adjusted) return;
  apply_global_problem(map_, *adjusted);
  note_all_moved_keyframes();
}

void Mapper::forget_removed() {
  constexpr std::size_t kRecent = 1000;  // snapshots and proposals that are under way may refer to them
  map_.forget_removed(kRecent);
}

void Mapper::finish_adjustment() {
  adjuster_.wait();
  apply_adjustment();
}

/// After a correction of the whole map; KeyframeChangeQueue splits the changes into portions.
void Mapper::note_all_moved_keyframes() {
  std::vector<KeyframeId> all;
  all.reserve(announced_.size());
  for (const auto& [id, T_world_camera] : announced_) all.push_back(id);
  for (const KeyframeId id : all) note_if_moved(id);
}

/// Looks at the adjusted keyframes, and at some of the others in turn: the changes of a larger correction are announced
/// bit by bit, and the cost does not grow with the map.
void Mapper::note_moved_keyframes(std::vector<KeyframeId> adjusted) {
  constexpr int kOthers = 40;  // with the adjusted ones fewer than readers of the topic keep
  auto next = announced_.lower_bound(next_checked_);
  for (int i = 0; i < kOthers && !announced_.empty(); ++i) {
    if (next == announced_.end()) next = announced_.begin();
    adjusted.push_back((next++)->first);
  }
  next_checked_ = next == announced_.end() ? 0 : next->first;
  std::sort(adjusted.begin(), adjusted.end());
  adjusted.erase(std::unique(adjusted.begin(), adjusted.end()), adjusted.end());
  for (const KeyframeId id : adjusted) note_if_moved(id);
}

void Mapper::note_if_moved(KeyframeId id) {
  const auto announced = announced_.find(id);
  if (announced == announced_.end()) return;  // culled since
  const Keyframe& keyframe = *map_.find_keyframe(id);
  const Eigen::Isometry3d T_announced_now = announced->second.inverse() * keyframe.T_world_camera;
  if (T_announced_now.translation().norm() < config_.mapper.correction_m &&
      geometry::rotation_angle_rad(T_announced_now) < config_.mapper.correction_rad) {
    return;
  }
  announced->second = keyframe.T_world_camera;
  changes_.push_back(
      {KeyframeChange::Kind::kCorrected, id, keyframe.frame->seq, keyframe.frame->stamp_ns, keyframe.T_world_camera});
}

LocalMapPtr Mapper::local_map(KeyframeId centre) {
  return make_local_map(map_, map_.living_ancestor(centre).first, ++snapshots_);
}

std::vector<LocalMapPtr> Mapper::places_like(const Frame& frame, std::size_t first, std::size_t count) {
  constexpr std::size_t kKeyframes = 20;  // of a place: enough to confirm a pose, quickly copied
  if (vocabulary_ == nullptr) return {};
  PlaceQuery query;
  query.max_candidates = static_cast<std::size_t>(config_.place.candidates);
  const auto candidates = find_places(places_, map_, vocabulary_->describe(frame.features), query);
  std::vector<LocalMapPtr> places;
  for (std::size_t i = 0; i < std::min(count, candidates.size()); ++i) {
    const KeyframeId keyframe = candidates[(first + i) % candidates.size()].keyframe;
    places.push_back(make_local_map(map_, keyframe, ++snapshots_, kKeyframes));
  }
  return places;
}

std::vector<KeyframeChange> Mapper::take_back() const {
  std::vector<KeyframeChange> changes;
  for (const auto& [id, T_world_camera] : announced_) {
    const Frame& frame = *map_.find_keyframe(id)->frame;
    changes.push_back({KeyframeChange::Kind::kRemoved, id, frame.seq, frame.stamp_ns, T_world_camera});
  }
  return changes;
}

std::vector<KeyframeChange> Mapper::take_changes() {
  return std::exchange(changes_, {});
}

}  // namespace rtd::slam
