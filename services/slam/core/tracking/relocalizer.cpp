// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/relocalizer.hpp"

#include <algorithm>

#include "common/msg/stamps.hpp"

namespace rtd::slam {

bool agrees_widely(const Frame& frame, const LocalMapTracking& tracking, double min_found_ratio) {
  const auto possible = static_cast<double>(std::min(tracking.visible.size(), frame.features.size()));
  return tracking.guess.success && tracking.guess.inliers >= min_found_ratio * possible;
}

bool is_convincing(const Frame& frame, const LocalMapTracking& tracking, const PlaceConfig& config) {
  return tracking.guess.inliers >= config.min_inliers && agrees_widely(frame, tracking, config.min_found_ratio);
}

void Relocalizer::settle(LocalMapPtr map) {
  state_ = State::kIdle;
  located_ = true;
  place_ = std::move(map);
  frames_at_place_ = 0;
}

LocalMapPtr Relocalizer::choose_map(const LocalMapPtr& snapshot, KeyframeId reference) {
  constexpr int kMaxFramesAtPlace = 30;  // the awaited keyframe may have been removed
  if (place_ == nullptr) return snapshot;
  if (snapshot->find_keyframe(reference) == nullptr && ++frames_at_place_ <= kMaxFramesAtPlace) return place_;
  place_.reset();
  return snapshot;
}

/// Lost, or about to be although the view is rich: the camera was carried away.
bool Relocalizer::may_search(const Frame& frame, bool had_pose) const {
  constexpr std::size_t kFeatures = 15, kRichView = 100;
  if (!config_.techniques.place_recognition || !places_) return false;
  return frame.features.size() >= (had_pose ? kRichView : kFeatures);
}

std::optional<Relocalizer::Found> Relocalizer::search(const FramePtr& frame, bool had_pose,
                                                      const TrackingContext& context) {
  if (!may_search(*frame, had_pose)) return std::nullopt;
  state_ = State::kSearching;
  for (const LocalMapPtr& place : places_(frame, attempts_++)) {
    auto tracking = track_place(*frame, *place, context);
    if (!tracking || !is_convincing(*frame, *tracking, config_.place)) continue;
    state_ = State::kConfirming;
    confirmations_ = -1;  // the frame itself does not count
    place_ = place;
    frames_at_place_ = 0;
    return Found{place, std::move(*tracking)};
  }
  return std::nullopt;
}

bool Relocalizer::confirm() {
  if (state_ == State::kConfirming && ++confirmations_ < config_.place.confirmations) return false;
  state_ = State::kIdle;
  located_ = true;
  attempts_ = 0;
  return true;
}

void Relocalizer::accept() {
  if (state_ == State::kConfirming) confirmations_ = config_.place.confirmations - 1;
}

void Relocalizer::give_up() {
  if (state_ == State::kConfirming) state_ = State::kSearching;
}

double UnknownViewClock::observe(std::int64_t stamp_ns, bool rich) {
  constexpr double kMaxGap_s = 0.5;
  if (rich && last_ns_ && stamp_ns > *last_ns_) {
    unknown_s_ += std::min(kMaxGap_s, msg::minus_s(stamp_ns, *last_ns_));
  }
  last_ns_.reset();
  if (rich) last_ns_ = stamp_ns;
  return unknown_s_;
}

}  // namespace rtd::slam
