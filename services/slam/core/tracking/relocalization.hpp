// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "services/slam/core/tracking/tracking_steps.hpp"

namespace rtd::slam {

/// A frame found at one of several places.
struct Relocalization {
  LocalMapPtr place;
  LocalMapTracking tracking;
};

/// Whether more landmarks were found than chance makes agree with any pose: a part of those that should be seen, or of
/// the frame's features where these are fewer. docs/theory/place_recognition.md Eq. (5).
bool agrees_widely(const Frame& frame, const LocalMapTracking& tracking, const PlaceConfig& config);

/// Whether a pose found by descriptors alone can be believed.
bool is_convincing(const Frame& frame, const LocalMapTracking& tracking, const PlaceConfig& config);

/// Tries the places in turn: descriptors of the centre keyframe, RANSAC, optimisation, then the landmarks around it
/// where that pose shows them. The first place that the frame clearly belongs to; empty when there is none.
/// docs/theory/place_recognition.md, "Relocalisation".
std::optional<Relocalization> relocalize(const Frame& frame, std::span<const LocalMapPtr> places,
                                         const TrackingContext& context);

/// Measures how long the camera has looked at what nobody knows: frames in which it sees enough, but is lost. Time
/// without a view (a covered camera) does not count, nor does a gap between two frames.
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
