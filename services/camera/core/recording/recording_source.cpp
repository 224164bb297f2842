// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/recording/recording_source.hpp"

#include <utility>

#include "services/camera/core/recording/image_pairs.hpp"

namespace rtd::camera {

RecordingSource::RecordingSource(std::string uri, std::unique_ptr<Recording> recording, const RecordingOptions& options)
    : recording_(std::move(recording)), frames_(std::make_unique<ImagePairs>(*recording_, options)) {
  info_ = frames_->info();
  info_.uri = std::move(uri);
  first_ = read_next();
  if (!first_) throw SourceError("no usable frame in " + recording_->name() + skips_.summary());
}

std::optional<SourceFrame> RecordingSource::next() {
  std::optional<SourceFrame> frame = first_ ? std::exchange(first_, std::nullopt) : read_next();
  if (!frame) return frame;
  frame->image.seq = skips_.counters().frames++;
  if (!frame->has_depth) ++skips_.counters().frames_without_depth;
  return frame;
}

std::uint64_t RecordingSource::pass_over(std::int64_t stamp_ns) {
  std::uint64_t passed = 0;
  if (first_ && first_->image.stamp_ns < stamp_ns) {
    first_.reset();
    ++passed;
  }
  while (!first_) {
    if (!gone_to_) gone_to_ = frames_->advance(skips_);
    if (!gone_to_ || *gone_to_ >= stamp_ns) break;
    gone_to_.reset();
    ++passed;
  }
  skips_.counters().frames += passed;
  return passed;
}

std::optional<SourceFrame> RecordingSource::read_next() {
  while (gone_to_ || (gone_to_ = frames_->advance(skips_))) {
    gone_to_.reset();
    take_damages();
    if (std::optional<SourceFrame> frame = frames_->decode(skips_)) return frame;
  }
  take_damages();
  return std::nullopt;
}

void RecordingSource::take_damages() {
  for (std::string& damage : recording_->take_damages()) skips_.add({SkipReason::kDamagedRecord, std::move(damage)});
}

}  // namespace rtd::camera
