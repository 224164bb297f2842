// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/place_policy.hpp"

#include <algorithm>

#include "common/msg/stamps.hpp"

namespace rtd::slam {
namespace {

constexpr double kNewMap_s = 3;    ///< a map is new for so long after its first pose, and ...
constexpr double kStart_s = 10;    ///< ... for so long after the first frame
constexpr double kLost_s = 0.5;    ///< the camera may be found at once
constexpr double kPeriod_s = 0.5;  ///< between two frames that are asked about
constexpr double kPatience_s = 3;  ///< until the camera is found in a map that was taken
constexpr double kPause_s = 10;
constexpr std::size_t kQueries = 8;  ///< an answer may be so much behind

}  // namespace

void PlacePolicy::begin_map(bool loaded) {
  loaded_ = loaded;
  first_ns_.reset();
  begun_ns_.reset();
  lost_ns_.reset();
  taken_.reset();
  queries_.clear();
}

void PlacePolicy::update(const msg::TrackingResult& result) {
  if (result.stamp_ns < now_ns_) {  // the source started again: the map is what it was
    begin_map(true);
    paused_ns_.reset();
  }
  now_ns_ = result.stamp_ns;
  const bool measured = msg::is_measured(result.state);
  if (!first_ns_) first_ns_ = now_ns_;
  if (!begun_ns_ && measured) begun_ns_ = now_ns_;
  if (result.state != msg::TrackingState::kLost) {
    lost_ns_.reset();
  } else if (!lost_ns_) {
    lost_ns_ = now_ns_;
  }
  if (!taken_ || !measured) return;
  taken_->elsewhere = result.map_id >= taken_->next_map;
  if (!taken_->elsewhere) taken_.reset();
}

double PlacePolicy::since_s(std::int64_t stamp_ns) const {
  return msg::minus_s(now_ns_, stamp_ns);
}

bool PlacePolicy::is_new() const {
  return !loaded_ && first_ns_ && since_s(*first_ns_) < kStart_s && (!begun_ns_ || since_s(*begun_ns_) < kNewMap_s);
}

bool PlacePolicy::wanted() const {
  if (taken_ || (paused_ns_ && since_s(*paused_ns_) < kPause_s)) return false;
  return is_new() || (lost_ns_ && since_s(*lost_ns_) > kLost_s);
}

bool PlacePolicy::due() const {
  return wanted() && (queries_.empty() || since_s(queries_.back()) >= kPeriod_s);
}

void PlacePolicy::note_query() {
  queries_.push_back(now_ns_);
  if (queries_.size() > kQueries) queries_.pop_front();
}

bool PlacePolicy::is_answer(std::int64_t stamp_ns) const {
  return std::ranges::find(queries_, stamp_ns) != queries_.end();
}

void PlacePolicy::take(MapId next_map) {
  begin_map(true);
  taken_ = Taken{now_ns_, next_map};
}

bool PlacePolicy::failed() const {
  return taken_ && (taken_->elsewhere || since_s(taken_->stamp_ns) >= kPatience_s);
}

}  // namespace rtd::slam
