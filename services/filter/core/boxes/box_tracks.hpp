// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/vision/detection.hpp"
#include "services/filter/core/boxes/kalman.hpp"
#include "services/filter/core/config/filter_config.hpp"
#include "services/filter/core/surfaces/cell_masks.hpp"

namespace rtd::filter {

/// The boxes that the detector found in the frame with this stamp, perhaps none.
struct DetectionBatch {
  std::int64_t stamp_ns = 0;
  std::vector<vision::Detection> detections;
  vision::PersonMasks masks = {};  ///< of `detections`; empty: boxes alone
};

/// What has arrived from the detector since the previous frame.
struct DetectorUpdate {
  bool active = false;                  ///< a detector is running: no batch means "not yet"; false: geometry only
  std::vector<DetectionBatch> batches;  ///< new ones by stamp, of this frame or, arriving late, of earlier ones
};

/// The boxes of one frame; nullopt = no detector is running.
using Detections = std::optional<std::vector<vision::Detection>>;
/// The update that brings the boxes of exactly this frame.
inline DetectorUpdate update_for(std::int64_t stamp_ns, const Detections& detections) {
  if (!detections) return {};
  return {true, {{stamp_ns, *detections}}};
}

/// What a frame adds to the tracks besides detections.
struct TrackedFrame {
  std::int64_t stamp_ns = 0;
  double width_px = 0, height_px = 0;
  Eigen::Vector2d size_px() const { return {width_px, height_px}; }
};

/// A track's box in the newest frame.
struct TrackedBox {
  int id = 0;                   ///< unique until clear()
  vision::Detection detection;  ///< the detector's own box if it found the object in this frame, else the carried one
  bool carried = false;
  double depth_m = 0;  ///< of the object, 0 = unknown
  double age_s = 0;    ///< since it was seen first
  BoxMask mask = {};   ///< its newest one, not older than kMaskLivesNs; may be empty
};

/// One step of a box from image to image that optical flow may measure.
struct CarryStep {
  std::int64_t from_ns = 0, to_ns = 0;
  Box box;             ///< in the image at from_ns
  double depth_m = 0;  ///< of the object there, 0 = unknown
  const std::string& class_name;
};
struct CarriedBox {
  BoxFlow flow;
  double depth_m = 0;
};

/// Depth of the object in a box of the frame with this stamp, 0 = unknown.
using DepthOfBox = std::function<double(std::int64_t stamp_ns, const vision::Detection&)>;
using MeasureCarry = std::function<std::optional<CarriedBox>(const CarryStep&)>;

/// Boxes with an identity: born from a detection, confirmed by a second one, they survive the detector's misses and
/// silence for a while. Each keeps its states by stamp, so that detections of an earlier frame are compared with the
/// state of that frame, and the correction is carried forward (docs/theory/dynamic_points.md section 6). Bounded:
/// kMaxTracks, kMaxFrames. Deterministic.
class BoxTracks {
 public:
  explicit BoxTracks(const BoxTrackConfig& config) : config_(config) {}

  /// Every frame in order of time: predicts all boxes into it.
  void begin_frame(const TrackedFrame& frame);
  /// Updates the tracks with the detections of this frame or an earlier one. Ignored: a second batch for the same
  /// stamp, one from the future, one older than the remembered frames. The detections are finite, not empty and at most
  /// kMaxTracks.
  void update(const DetectionBatch& batch, const DepthOfBox& depth_of);
  /// Moves boxes that were not seen by what `measure` finds; where it finds nothing they keep their predicted motion.
  void carry(const MeasureCarry& measure);
  /// Drops what has left the image or has not been seen for too long, then all boxes of the newest frame, best score
  /// first.
  std::vector<TrackedBox> boxes();
  /// The object's depth according to its mask in the newest frame.
  void set_depth(int id, double depth_m);
  void clear();

  static constexpr std::size_t kMaxTracks = 64, kMaxFrames = 32;
  static constexpr std::int64_t kMaskLivesNs = 300'000'000;  ///< people change their shape meanwhile

 private:
  /// A track in one frame.
  struct Step {
    std::int64_t stamp_ns;
    BoxKalman state;
    std::optional<BoxFlow> flow;  ///< from the step before
    bool flow_tried = false;
    std::optional<vision::Detection> seen;
    double depth_m = 0;
  };
  struct Track {
    int id;
    std::deque<Step> steps;  ///< by stamp, one per frame since it was first seen, bounded
    std::map<std::string, double> votes;
    float score = 0;
    int hits = 1, misses = 0;  ///< misses since the last hit
    std::int64_t first_ns = 0, last_hit_ns = 0;
    bool dead = false;
    BoxMask mask;
    std::int64_t mask_ns = 0;
  };
  std::optional<std::size_t> frame_of(std::int64_t stamp_ns) const;
  double match_cost(const Track& track, const Step& step, const vision::Detection& detection, double depth_m) const;
  void hit(Track& track, std::size_t step, const vision::Detection& detection, double depth_m);
  static void keep_mask(Track& track, const DetectionBatch& batch, std::size_t detection, std::int64_t stamp_ns);
  void miss(Track& track, std::size_t step, const TrackedFrame& frame) const;
  void start_track(const DetectionBatch& batch, std::size_t detection, std::size_t frame, double depth_m);
  void replay(Track& track, std::size_t from) const;
  bool expired(const Track& track) const;

  BoxTrackConfig config_;
  std::deque<TrackedFrame> frames_;
  std::deque<std::int64_t> batches_ns_;
  std::vector<Track> tracks_;
  int next_id_ = 0;
};

}  // namespace rtd::filter
