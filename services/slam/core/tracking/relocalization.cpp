// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/relocalization.hpp"

#include <algorithm>

namespace rtd::slam {

bool agrees_widely(const Frame& frame, const LocalMapTracking& tracking, const PlaceConfig& config) {
  const auto possible = static_cast<double>(std::min(tracking.visible.size(), frame.features.size()));
  return tracking.guess.success && tracking.guess.inliers >= config.min_found_ratio * possible;
}

bool is_convincing(const Frame& frame, const LocalMapTracking& tracking, const PlaceConfig& config) {
  return tracking.guess.inliers >= config.min_inliers && agrees_widely(frame, tracking, config);
}

std::optional<Relocalization> relocalize(const Frame& frame, std::span<const LocalMapPtr> places,
                                         const TrackingContext& context) {
  for (const LocalMapPtr& place : places) {
    const PoseGuess coarse = track_keyframe(frame, place->keyframes.front(), *place, context);
    if (!coarse.success) continue;
    LocalMapTracking tracking = track_local_map(frame, *place, coarse, context);
    if (!tracking.guess.success) continue;
    tracking = track_local_map(frame, *place, tracking.guess, context);  // from a coarse pose many are missed
    if (is_convincing(frame, tracking, context.config.place)) return Relocalization{place, std::move(tracking)};
  }
  return std::nullopt;
}

double UnknownViewClock::observe(std::int64_t stamp_ns, bool rich) {
  constexpr double kMaxGap_s = 0.5;
  if (rich && last_ns_ && stamp_ns > *last_ns_) {
    unknown_s_ += std::min(kMaxGap_s, static_cast<double>(stamp_ns - *last_ns_) * 1e-9);
  }
  last_ns_.reset();
  if (rich) last_ns_ = stamp_ns;
  return unknown_s_;
}

}  // namespace rtd::slam
