// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <vector>

#include "services/filter/core/boxes/object_tracker.hpp"
#include "services/filter/core/config/filter_config.hpp"
#include "services/filter/core/modes/mode_judge.hpp"
#include "services/filter/core/movers/world_movers.hpp"
#include "services/filter/core/orb/orb_extractor.hpp"

namespace rtd::filter {

/// What the filter found out about one frame.
struct FilterResult : Verdict {
  std::vector<SceneObject> objects;
  std::uint32_t removed = 0;  ///< features flagged as removed
  GridShape cells;            ///< shape of `motion`, in undistorted pixels; 0x0 in mode off
  StageTimes stage_ms{};      ///< waiting not included
};

/// The features of one frame, all of them, before any judgement.
struct Extraction {
  std::vector<msg::Feature> features;
  float ms = 0;  ///< what finding them took
};

/// How much work goes into a frame, below what is configured.
struct Effort {
  double feature_share = 1;         ///< of orb.feature_count
  bool coarse_depth_check = false;  ///< fewer earlier views, fewer proposals for the camera's motion
  int first_octave = 0;             ///< no features of finer ones
};

/// Separates the static world from what moves: which features slam may use, and how much each of them counts. The
/// theory is in docs/theory/dynamic_points.md.
///
/// Give it every frame in order of time, and slam's poses and keyframes as they arrive. Deterministic in that order of
/// calls. One thread, but for extract(), which may be called in a second one at the same time as everything else.
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
  Extraction extract(const vision::RgbdImage& image);
  FilterResult judge(const vision::RgbdImage& image, Extraction extraction, const DetectorUpdate& detector);

  /// The objects of the frame that was judged last, with its image and result. For people who watch, not for features.
  std::vector<ObjectSighting> sight_objects(const vision::RgbdImage& image, const FilterResult& result) const {
    const auto color_bgr = [&](std::size_t cell) { return sampler_.color_bgr(image, cell); };
    return filter::sight_objects(result.objects, result, {grid_, sampler_.rays(), color_bgr});
  }

  /// What an IMU next to the camera measured, in order of time and before the frame that ends there: its gyroscope says
  /// how the camera has turned.
  void add(const inertial::ImuSample& sample) { gyroscope_.add(sample); }

  /// slam's pose of an earlier frame: corrects the pose of its view and of later ones.
  void on_pose(const SlamPose& pose) { judge_->on_pose(pose); }
  void on_keyframe(const SlamKeyframe& keyframe) { judge_->on_keyframe(keyframe); }
  /// Forgets all earlier frames, e.g. when time went backwards.
  void reset();
  /// Judges by another mode from the next frame on. What the old one knew is forgotten: views, objects and beliefs. The
  /// new one begins as after a start: for the first frames it has nothing to compare with.
  void set_mode(FilterMode mode);
  FilterMode mode() const { return config_.mode; }
  /// From the next frame on. Nothing is forgotten.
  void set_effort(const Effort& effort);

 private:
  void choose_feature_count();
  Surfaces divide_into_surfaces(const vision::RgbdImage& image);
  std::vector<SceneObject> find_objects(const vision::RgbdImage& image, const Surfaces& surfaces,
                                        const DetectorUpdate& detector);
  FilterResult complete(Verdict verdict, std::vector<SceneObject> objects, const GridShape& cells,
                        const StageClock& clock, float extract_ms);

  FilterConfig configured_;
  FilterConfig config_;  ///< effective_config() of the mode
  std::function<std::int64_t()> now_ns_;
  OrbExtractor extractor_;
  DepthGridSampler sampler_;
  DepthGrid grid_;  ///< of the last judged frame
  ObjectTracker objects_;
  Gyroscope gyroscope_;
  std::unique_ptr<ModeJudge> judge_;
  Effort effort_;
  bool something_masked_ = true;  ///< in the last frame; the first is treated as if
  std::atomic<int> wanted_features_{0}, first_octave_{0};
};

}  // namespace rtd::filter
