// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "common/msg/features.hpp"
#include "common/msg/tracking.hpp"
#include "common/vision/detection.hpp"
#include "common/vision/motion_levels.hpp"
#include "common/vision/rgbd_image.hpp"
#include "services/filter/core/belief/belief_update.hpp"
#include "services/filter/core/filter_config.hpp"
#include "services/filter/core/modes/published_mode.hpp"
#include "services/filter/core/motion/dynamic_memory.hpp"
#include "services/filter/core/motion/dynamic_regions.hpp"
#include "services/filter/core/motion/ego_motion.hpp"
#include "services/filter/core/motion/view_store.hpp"
#include "services/filter/core/orb/orb_extractor.hpp"
#include "services/filter/core/surfaces/object_masks.hpp"
#include "services/filter/core/tracks/detection_batch.hpp"
#include "services/filter/core/tracks/mover_tracks.hpp"
#include "services/filter/core/tracks/object_follower.hpp"

namespace rtd::filter {

/// What is known of the motion of a grid cell; the values are grey values of the picture that is published.
enum class CellMotion : std::uint8_t {
  kStatic = 0,
  kUnknown = 128,  ///< nothing that may move covers the cell, but whether it moves could not be found out
  kDynamic = 255,  ///< moves, or belongs to an object of a high level; grown by masks.dilate_cells
};

/// What the filter found out about one frame.
struct FilterResult {
  std::vector<msg::Feature> features;  ///< removed ones included and flagged
  std::vector<SceneObject> objects;
  std::vector<Mover> movers;           ///< without a class, in view or expected to come back
  std::uint32_t removed = 0;           ///< features flagged as removed
  std::uint32_t dynamic_clusters = 0;  ///< depth clusters that geometry found moving, with or without a class
  bool pose_reliable = false;          ///< geometry had a pose and could speak
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< the quick estimate
  GridShape cells;                                   ///< shape of `motion`, in undistorted pixels; 0x0 in mode off
  std::vector<CellMotion> motion;                    ///< per cell
  std::array<float, msg::kFilterStages> stage_ms{};  ///< by msg::FilterStage, waiting not included
};

/// Tells the static world from what moves, DESIGN section 4: which features slam may use, and how much. The theory is
/// in docs/theory/dynamic_points.md.
///
/// Give it every frame in order of time, and what slam says as it comes. Deterministic in that order of calls. One
/// thread.
class DynamicFilter {
 public:
  /// `now_ns`: any monotonic clock, for stage times only. Throws std::invalid_argument for an unknown motion level.
  DynamicFilter(const FilterConfig& config, std::function<std::int64_t()> now_ns);

  FilterResult apply(const vision::RgbdImage& image, const DetectorWord& word) {
    return judge(image, extract(image), word);
  }
  FilterResult apply(const vision::RgbdImage& image, const Detections& detections) {
    return apply(image, word_of(image.stamp_ns, detections));
  }
  /// The two halves of apply(), for a caller that waits for the detections in between.
  std::vector<msg::Feature> extract(const vision::RgbdImage& image);
  FilterResult judge(const vision::RgbdImage& image, std::vector<msg::Feature> features, const DetectorWord& word);

  /// slam's pose of an earlier frame: corrects the pose of its view and of those after it.
  void on_tracking(const msg::TrackingResult& result);
  /// A frame became a keyframe, or its pose was corrected.
  void on_keyframe(const msg::KeyframeEvent& event);
  /// Forgets all that was seen, e.g. when time went backwards.
  void reset();

 private:
  struct Scene;     // the frame in cells: depth, surfaces, objects
  struct Geometry;  // pose and evidence
  Scene look_at(const vision::RgbdImage& image);
  void find_what_may_move(const DetectorWord& word, Scene& scene, FilterResult& result);
  void judge_as_published(const Scene& scene, FilterResult& result);
  CellBeliefs recall_beliefs(const Scene& scene, const Eigen::Isometry3d& T_world_camera) const;
  void trust_known_surfaces(Scene& scene) const;
  CellMask recall_movers(const Scene& scene, const Eigen::Isometry3d& T_world_camera) const;
  void follow_movers(const Scene& scene, const Geometry& geometry, FilterResult& result);
  Geometry find_what_moves(const Scene& scene, FilterResult& result);
  void weigh(const Scene& scene, const Geometry& geometry, FilterResult& result);
  void remember(Scene scene, const Geometry& geometry, FilterResult& result);

  FilterConfig config_;
  std::function<std::int64_t()> now_ns_;
  MotionLevels levels_;
  OrbExtractor extractor_;
  DepthGridSampler sampler_;
  ViewStore views_;
  std::uint32_t map_ = 0;  ///< that slam's last pose was in
  DynamicMemory memory_;
  MoverTracks movers_;
  SurfaceBeliefs beliefs_;
  ObjectFollower follower_;
  std::unique_ptr<PublishedMode> published_;  ///< somebody else's rule in place of ours; null in our own modes
  bool something_masked_ = true;              ///< in the last frame; the first is treated as if
  float extract_ms_ = 0;
};

}  // namespace rtd::filter
