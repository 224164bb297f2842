// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "services/slam/core/tracking/tracking_steps.hpp"

namespace rtd::slam {

/// Whether more landmarks were found than chance makes agree with any pose: a part of those that should be seen, or of
/// the frame's features where these are fewer. docs/theory/place_recognition.md Eq. (5).
bool agrees_widely(const Frame& frame, const LocalMapTracking& tracking, double min_found_ratio);

/// Whether a pose found by descriptors alone can be believed.
bool is_convincing(const Frame& frame, const LocalMapTracking& tracking, const PlaceConfig& config);

/// Parts of the map around places that look like a frame; every attempt of a search gives others. May be empty.
using PlaceSource = std::function<std::vector<LocalMapPtr>(const FramePtr&, std::size_t attempt)>;

/// Finds a camera that tracking has lost at the places that look like what it sees. A recognised place counts only
/// after the next frames agree with it. docs/theory/place_recognition.md, "Relocalisation". Not thread-safe.
class Relocalizer {
 public:
  enum class State : std::uint8_t {
    kIdle,        ///< tracking knows the pose, or looks for the camera around its last pose
    kSearching,   ///< no place has agreed so far; every attempt tries other places
    kConfirming,  ///< a place was recognised; the next frames have to agree
  };

  /// Without `places` nothing is ever found.
  Relocalizer(const SlamConfig& config, PlaceSource places) : config_(config), places_(std::move(places)) {}

  State state() const { return state_; }
  /// False after a map was loaded, until the camera is found in it.
  bool located() const { return located_; }
  /// A map was loaded: the camera is anywhere in it, or elsewhere.
  void await() { located_ = false; }
  /// The camera is in `map`, whose first keyframe it has just made.
  void settle(LocalMapPtr map);
  /// What the next frame is compared with: the snapshot, or the place where the camera entered the map until the
  /// mapper's snapshots, which come from another thread, contain the keyframe `reference`.
  LocalMapPtr choose_map(const LocalMapPtr& snapshot, KeyframeId reference);

  /// A frame found at a place.
  struct Found {
    LocalMapPtr place;
    LocalMapTracking tracking;
  };
  /// Looks for a frame that could not be tracked; `had_pose`: the frame before it was tracked. When it is found, the
  /// state is kConfirming.
  std::optional<Found> search(const FramePtr& frame, bool had_pose, const TrackingContext& context);
  /// The frame was tracked, at the recognised place if there is one. True when its pose counts.
  bool confirm();
  /// The place was expected: the frame that was found there counts at once.
  void accept();
  /// The frame was neither tracked nor found.
  void give_up();
  /// The frame before the present one was at the recognised place already.
  bool entered() const { return state_ == State::kConfirming && confirmations_ >= 0; }

 private:
  bool may_search(const Frame& frame, bool had_pose) const;

  SlamConfig config_;
  PlaceSource places_;
  State state_ = State::kIdle;
  bool located_ = true;
  std::size_t attempts_ = 0;  ///< of the present search
  int confirmations_ = 0;     ///< frames that agreed with the recognised place
  LocalMapPtr place_;         ///< where the camera entered the map; null once the snapshots have followed
  int frames_at_place_ = 0;
};

/// Measures how long the camera has seen unknown views: frames in which it sees enough, but is lost. Time without a
/// view (a covered camera) does not count, nor does a gap between two frames.
class UnknownViewClock {
 public:
  /// A lost frame; `rich`: a map could begin with it. Returns the time so far, s.
  double observe(std::int64_t stamp_ns, bool rich);
  void reset() { *this = {}; }

 private:
  std::optional<std::int64_t> last_ns_;
  double unknown_s_ = 0;
};

}  // namespace rtd::slam
