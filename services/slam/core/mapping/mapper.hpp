// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "common/msg/tracking.hpp"
#include "services/slam/core/loop/global_bundle_adjustment.hpp"
#include "services/slam/core/loop/loop_closer.hpp"
#include "services/slam/core/map/landmark.hpp"
#include "services/slam/core/map/local_map.hpp"
#include "services/slam/core/map/map.hpp"
#include "services/slam/core/mapping/mapping_steps.hpp"
#include "services/slam/core/place/keyframe_database.hpp"
#include "services/slam/core/place/vocabulary.hpp"

namespace rtd::slam {

/// A frame that is to become a keyframe. Its pose is relative to its reference keyframe, because the map may have moved
/// since it was tracked.
struct KeyframeProposal {
  FramePtr frame;
  KeyframeId reference =
      kNoKeyframe;  ///< kNoKeyframe: the first keyframe of a new map, T_reference_camera is its world pose
  Eigen::Isometry3d T_reference_camera = Eigen::Isometry3d::Identity();
  std::vector<LandmarkId> landmarks;  ///< per feature
  std::vector<LandmarkStatistics> statistics;
  std::optional<geometry::Matrix6d> covariance = std::nullopt;  ///< Keyframe::covariance
  bool carried = true;                                          ///< Keyframe::carried
  double probation_weight = 1;                                  ///< Keyframe::probation_weight
};

/// What became of a keyframe since it was last announced.
struct KeyframeChange {
  using Kind = msg::KeyframeEventKind;
  Kind kind = Kind::kCreated;
  KeyframeId id = kNoKeyframe;
  std::uint64_t frame_seq = 0;
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

/// Local mapping, docs/theory/mapping.md: grows the map by keyframes, makes and culls landmarks, adjusts the
/// neighbourhood. The only writer of the map; one thread at a time.
class Mapper {
 public:
  explicit Mapper(const SlamConfig& config);

  /// Continues a saved map. Its keyframes are not announced: no other service has their frames.
  void restore(MapContents contents);
  /// Takes a keyframe into the map. `interrupted` (another keyframe waits) shortens the work.
  KeyframeId insert(const KeyframeProposal& proposal, const std::function<bool()>& interrupted = {});
  /// A snapshot around `centre`, or around its closest remaining ancestor if it was removed.
  LocalMapPtr local_map(KeyframeId centre);
  /// The parts of the map around the places that look like this frame: `count` of them from rank `first` on, going
  /// round; fewer when there are fewer places. Empty without place recognition.
  std::vector<LocalMapPtr> places_like(const Frame& frame, std::size_t first, std::size_t count);
  /// Created, corrected and removed keyframes since the last call, in order.
  std::vector<KeyframeChange> take_changes();
  /// Every announced keyframe as removed: the map is to be forgotten.
  std::vector<KeyframeChange> take_back() const;
  /// Global bundle adjustment runs next to the mapper from now on; `on_done` reports, from its thread, that
  /// apply_adjustment() has something to apply.
  void adjust_in_background(std::function<void()> on_done) { adjuster_.run_in_background(std::move(on_done)); }
  void apply_adjustment();
  /// Waits for a global bundle adjustment that is running, and applies it.
  void finish_adjustment();
  /// Gives up an adjustment that is under way: the map stays as the loop closure left it.
  void cancel_adjustment() { adjuster_.cancel(); }
  /// Map::forget_removed(): of no use are those that no loop ends at and that nothing recent refers to.
  void forget_removed();
  const std::vector<LoopClosure>& loops() const { return loops_; }
  const Map& map() const { return map_; }
  /// Words of all keyframes in the map; empty when place recognition is off.
  const KeyframeDatabase& places() const { return places_; }
  /// Null when place recognition is off.
  const std::shared_ptr<const Vocabulary>& vocabulary() const { return vocabulary_; }

 private:
  KeyframeId add_keyframe(const KeyframeProposal& proposal);
  void confirm_witnesses(KeyframeId id);
  void count_statistics(const std::vector<LandmarkStatistics>& statistics);
  void create_landmarks(KeyframeId keyframe);
  void cull_keyframes(KeyframeId newest);
  void close_loop(KeyframeId newest);
  void note_all_moved_keyframes();
  void note_moved_keyframes(std::vector<KeyframeId> adjusted);
  void note_if_moved(KeyframeId keyframe);
  bool due_for_adjustment(KeyframeId newest) const;

  SlamConfig config_;
  Map map_;
  std::shared_ptr<const Vocabulary> vocabulary_;
  KeyframeDatabase places_;
  RecentLandmarks recent_;
  LoopCloser loop_closer_;
  std::vector<LoopClosure> loops_;
  GlobalAdjuster adjuster_;
  std::map<KeyframeId, Eigen::Isometry3d> announced_;  ///< T_world_camera as last announced
  KeyframeId next_checked_ = 0;                        ///< in turn, of those that were not adjusted
  std::vector<KeyframeChange> changes_;
  std::uint64_t snapshots_ = 0;
  std::int64_t adjusted_ns_ = 0;  ///< stamp of the keyframe after which the map was last adjusted
};

}  // namespace rtd::slam
