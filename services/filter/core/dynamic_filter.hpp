// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "services/filter/core/filter_config.hpp"
#include "services/filter/core/modes/mode_judge.hpp"
#include "services/filter/core/orb/orb_extractor.hpp"
#include "services/filter/core/tracks/object_tracker.hpp"

namespace rtd::filter {

/// What the filter found out about one frame.
struct FilterResult : Verdict {
  std::vector<SceneObject> objects;
  std::uint32_t removed = 0;  ///< features flagged as removed
  GridShape cells;            ///< shape of `motion`, in undistorted pixels; 0x0 in mode off
  StageTimes stage_ms{};      ///< waiting not included
};

/// Separates the static world from what moves: which features slam may use, and how much each of them counts. The
/// theory is in docs/theory/dynamic_points.md.
///
/// Give it every frame in order of time, and slam's poses and keyframes as they arrive. Deterministic in that order of
/// calls. One thread.
class DynamicFilter {
 public:
  /// `now_ns`: any monotonic clock, for stage times only. Throws std::invalid_argument for an unknown motion level.
  DynamicFilter(const FilterConfig& config, std::function<std::int64_t()> now_ns);

  FilterResult apply(const vision::RgbdImage& image, const DetectorUpdate& detector) {
    return judge(image, extract(image), detector);
  }
  FilterResult apply(const vision::RgbdImage& image, const Detections& detections) {
    return apply(image, update_for(image.stamp_ns, detections));
  }
  /// The two halves of apply(), for a caller that waits for the detections in between.
  std::vector<msg::Feature> extract(const vision::RgbdImage& image);
  FilterResult judge(const vision::RgbdImage& image, std::vector<msg::Feature> features,
                     const DetectorUpdate& detector);

  /// slam's pose of an earlier frame: corrects the pose of its view and of later ones.
  void on_pose(const SlamPose& pose) { judge_->on_pose(pose); }
  void on_keyframe(const SlamKeyframe& keyframe) { judge_->on_keyframe(keyframe); }
  /// Forgets all earlier frames, e.g. when time went backwards.
  void reset();

 private:
  Surfaces divide_into_surfaces(const vision::RgbdImage& image);
  std::vector<SceneObject> find_objects(const vision::RgbdImage& image, const Surfaces& surfaces,
                                        const DetectorUpdate& detector);
  FilterResult complete(Verdict verdict, std::vector<SceneObject> objects, const GridShape& cells,
                        const StageClock& clock);

  FilterConfig config_;
  std::function<std::int64_t()> now_ns_;
  OrbExtractor extractor_;
  DepthGridSampler sampler_;
  ObjectTracker objects_;
  std::unique_ptr<ModeJudge> judge_;
  bool something_masked_ = true;  ///< in the last frame; the first is treated as if
  float extract_ms_ = 0;
};

}  // namespace rtd::filter
