// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/boxes/box_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/msg/stamps.hpp"
#include "services/filter/core/boxes/assignment.hpp"

namespace rtd::filter {
namespace {

/// Intersection over union of a track and a detection; less: not the same object.
constexpr double kMinBoxOverlap = 0.15;
constexpr double kMaxMatchCost = 1.0;  ///< 1 - overlap, plus another class and another depth; more: not the same object
constexpr int kConfirmBoxHits = 2;     ///< a track seen less often ends with the first miss

constexpr std::int64_t kSameFrameNs = 60'000'000;  // a batch for a dropped frame counts for the nearest one
constexpr double kVoteDecay = 0.9;                 // per hit: the class of a track can change

const std::string& voted_class(const std::map<std::string, double>& votes) {
  return std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

vision::Detection to_detection(const std::string& class_name, float score, const Box& box) {
  const Eigen::Vector2f corner = (box.centre_px - 0.5 * box.size_px).cast<float>(), size = box.size_px.cast<float>();
  return {class_name, score, corner.x(), corner.y(), size.x(), size.y()};
}

}  // namespace

void BoxTracks::begin_frame(const TrackedFrame& frame) {
  const std::int64_t dt_ns = frames_.empty() ? 0 : msg::minus_ns(frame.stamp_ns, frames_.back().stamp_ns);
  if (dt_ns < 0) clear();
  frames_.push_back(frame);
  if (frames_.size() > kMaxFrames) frames_.pop_front();
  for (Track& track : tracks_) {
    Step step = track.steps.back();
    step.state.predict(seconds(dt_ns));
    track.steps.push_back({frame.stamp_ns, step.state, std::nullopt, false, std::nullopt, step.depth_m});
    if (track.steps.size() > kMaxFrames) track.steps.pop_front();
  }
}

std::optional<std::size_t> BoxTracks::frame_of(std::int64_t stamp_ns) const {
  const bool around =
      !frames_.empty() && msg::minus_ns(frames_.front().stamp_ns, stamp_ns) <= kSameFrameNs;  // any number may come
  if (!around || stamp_ns > frames_.back().stamp_ns) return std::nullopt;
  const auto nearest = std::min_element(frames_.begin(), frames_.end(), [&](const auto& a, const auto& b) {
    return msg::apart_ns(a.stamp_ns, stamp_ns) < msg::apart_ns(b.stamp_ns, stamp_ns);
  });
  if (msg::apart_ns(nearest->stamp_ns, stamp_ns) > kSameFrameNs) return std::nullopt;
  return static_cast<std::size_t>(nearest - frames_.begin());
}

void BoxTracks::update(const DetectionBatch& batch, const DepthOfBox& depth_of) {
  const std::optional<std::size_t> frame = frame_of(batch.stamp_ns);
  const auto known = std::find(batches_ns_.begin(), batches_ns_.end(), batch.stamp_ns);
  if (!frame || known != batches_ns_.end()) return;
  const bool newest = batches_ns_.empty() || batch.stamp_ns > batches_ns_.back();
  const std::int64_t stamp_ns = frames_[*frame].stamp_ns;
  std::vector<double> depths;
  for (const vision::Detection& d : batch.detections) depths.push_back(depth_of(stamp_ns, d));

  std::vector<std::pair<Track*, std::size_t>> then;  // tracks that existed, and their step
  for (Track& track : tracks_) {
    for (std::size_t i = 0; i < track.steps.size(); ++i) {
      if (track.steps[i].stamp_ns == stamp_ns) then.emplace_back(&track, i);
    }
  }
  CostMatrix costs(static_cast<int>(then.size()), static_cast<int>(batch.detections.size()));
  for (std::size_t row = 0; row < then.size(); ++row) {
    const auto& [track, step] = then[row];
    for (std::size_t column = 0; column < batch.detections.size(); ++column) {
      costs.at(static_cast<int>(row), static_cast<int>(column)) =
          match_cost(*track, track->steps[step], batch.detections[column], depths[column]);
    }
  }
  const std::vector<int> column_of = assign(costs, kMaxMatchCost);
  std::vector<char> taken(batch.detections.size(), 0);
  for (std::size_t row = 0; row < then.size(); ++row) {
    const auto& [track, step] = then[row];
    if (column_of[row] >= 0) {
      const auto column = static_cast<std::size_t>(column_of[row]);
      taken[column] = 1;
      hit(*track, step, batch.detections[column], depths[column]);
      keep_mask(*track, batch, column, stamp_ns);
    } else if (newest) {
      miss(*track, step, frames_[*frame]);
    }
  }
  if (!newest) return;  // an older batch corrects tracks, but neither ends nor starts one
  batches_ns_.push_back(batch.stamp_ns);
  if (batches_ns_.size() > kMaxFrames) batches_ns_.pop_front();
  std::erase_if(tracks_, [](const Track& track) { return track.dead; });
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (taken[i] == 0) start_track(batch, i, *frame, depths[i]);
  }
}

double BoxTracks::match_cost(const Track& track, const Step& step, const vision::Detection& detection,
                             double depth_m) const {
  constexpr double kAnotherClass = 0.2, kDepthWeight = 0.3, kFarDepthM = 1.0;
  const double overlap = intersection_over_union(step.state.box(), box_of(detection));
  if (overlap < kMinBoxOverlap) return std::numeric_limits<double>::infinity();
  double cost = 1 - overlap;
  if (detection.class_name != voted_class(track.votes)) cost += kAnotherClass;
  if (depth_m > 0 && step.depth_m > 0) {
    cost += kDepthWeight * std::min(1.0, std::abs(depth_m - step.depth_m) / kFarDepthM);
  }
  return cost;
}

void BoxTracks::hit(Track& track, std::size_t step, const vision::Detection& detection, double depth_m) {
  Step& seen = track.steps[step];
  if (seen.seen) return;  // two batches for the same frame
  seen.seen = detection;
  if (depth_m > 0) seen.depth_m = depth_m;
  replay(track, step);
  for (auto& [name, votes] : track.votes) votes *= kVoteDecay;
  track.votes[detection.class_name] += static_cast<double>(detection.score);
  ++track.hits;
  if (seen.stamp_ns < track.last_hit_ns) return;
  track.last_hit_ns = seen.stamp_ns;
  track.score = detection.score;
  track.misses = 0;
}

/// The newest mask of the object, by the frame that shows it.
void BoxTracks::keep_mask(Track& track, const DetectionBatch& batch, std::size_t detection, std::int64_t stamp_ns) {
  if (batch.masks.empty() || detection >= vision::kMaxMasks) return;
  if (!track.mask.empty() && stamp_ns < track.mask_ns) return;
  BoxMask mask(batch.masks, static_cast<std::uint8_t>(detection + 1), batch.detections[detection]);
  if (mask.empty()) return;
  track.mask = std::move(mask);
  track.mask_ns = stamp_ns;
}

void BoxTracks::miss(Track& track, std::size_t step, const TrackedFrame& frame) const {
  constexpr double kMostlyVisible = 0.4;
  if (frame.stamp_ns <= track.last_hit_ns) return;
  if (visible_share(track.steps[step].state.box(), frame.size_px()) < kMostlyVisible) return;
  ++track.misses;
  const double unseen_s = msg::minus_s(frame.stamp_ns, track.last_hit_ns);
  const double known_s = msg::minus_s(track.last_hit_ns, track.first_ns);
  const double survive_s = std::min(config_.survive_misses_s, known_s);
  track.dead = track.hits < kConfirmBoxHits || (track.misses >= 2 && unseen_s > survive_s);
}

void BoxTracks::start_track(const DetectionBatch& batch, std::size_t detection, std::size_t frame, double depth_m) {
  if (tracks_.size() >= kMaxTracks) return;
  const vision::Detection& d = batch.detections[detection];
  Track track;
  track.id = next_id_++;
  track.votes[d.class_name] = static_cast<double>(d.score);
  track.score = d.score;
  track.first_ns = track.last_hit_ns = frames_[frame].stamp_ns;
  for (std::size_t i = frame; i < frames_.size(); ++i) {
    track.steps.push_back({frames_[i].stamp_ns, BoxKalman(box_of(d)), std::nullopt, i == frame, std::nullopt, depth_m});
  }
  track.steps.front().seen = d;
  replay(track, 1);
  keep_mask(track, batch, detection, frames_[frame].stamp_ns);
  tracks_.push_back(std::move(track));
}

/// Recomputes the states from step `from` on, with the measurements since then.
void BoxTracks::replay(Track& track, std::size_t from) const {
  for (std::size_t i = from; i < track.steps.size(); ++i) {
    Step& step = track.steps[i];
    if (i > 0) {
      const Step& before = track.steps[i - 1];
      const double dt_s = msg::minus_s(step.stamp_ns, before.stamp_ns);
      step.state = before.state;
      if (step.flow) step.state.flowed(*step.flow, dt_s);
      step.state.predict(dt_s);
    }
    if (step.seen) step.state.detected(box_of(*step.seen));
  }
}

void BoxTracks::carry(const MeasureCarry& measure) {
  for (Track& track : tracks_) {
    for (std::size_t i = 1; i < track.steps.size(); ++i) {
      Step& step = track.steps[i];
      if (step.flow_tried || step.seen) continue;
      const Step& before = track.steps[i - 1];
      const auto carried =
          measure({before.stamp_ns, step.stamp_ns, before.state.box(), before.depth_m, voted_class(track.votes)});
      step.flow_tried = true;
      step.depth_m = before.depth_m;
      if (!carried) continue;
      step.flow = carried->flow;
      if (carried->depth_m > 0) step.depth_m = carried->depth_m;
      replay(track, i);
    }
  }
}

bool BoxTracks::expired(const Track& track) const {
  constexpr double kHardlyVisible = 0.15;
  const Step& now = track.steps.back();
  if (now.seen) return false;
  return msg::minus_s(now.stamp_ns, track.last_hit_ns) > config_.silence_s ||
         visible_share(now.state.box(), frames_.back().size_px()) < kHardlyVisible;
}

std::vector<TrackedBox> BoxTracks::boxes() {
  std::erase_if(tracks_, [this](const Track& track) { return expired(track); });
  std::vector<TrackedBox> boxes;
  for (const Track& track : tracks_) {
    const Step& now = track.steps.back();
    vision::Detection detection =
        now.seen ? *now.seen : to_detection(voted_class(track.votes), track.score, now.state.box());
    boxes.push_back({track.id, std::move(detection), !now.seen.has_value(), now.depth_m,
                     msg::minus_s(now.stamp_ns, track.first_ns)});
    if (msg::minus_ns(now.stamp_ns, track.mask_ns) <= kMaskLivesNs) boxes.back().mask = track.mask;
  }
  return boxes;
}

void BoxTracks::set_depth(int id, double depth_m) {
  for (Track& track : tracks_) {
    if (track.id == id) track.steps.back().depth_m = depth_m;
  }
}

void BoxTracks::clear() {
  frames_.clear();
  batches_ns_.clear();
  tracks_.clear();
}

}  // namespace rtd::filter
