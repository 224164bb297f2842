// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/recording/recording_source.hpp"

#include <algorithm>
#include <utility>

namespace rtd::camera {
namespace {

std::unique_ptr<FrameAssembly> assemble(Recording& recording, const RecordingOptions& options) {
  const bool named = !options.topics.color.empty() || !options.topics.depth.empty();
  if (!named && !own_frames_topic(recording).empty()) return make_own_frames(recording);
  return make_image_pairs(recording, options);
}

}  // namespace

void describe_rate(Recording& recording, const std::string& topic, SourceInfo& info) {
  constexpr std::size_t kTimes = 16;  // each may have to be unpacked
  constexpr double kMinHz = 0.1, kMaxHz = 1000;
  info.frames = topic_named(recording, topic)->messages;
  const std::vector<std::int64_t> times_ns = recording.first_times_ns(topic, kTimes);
  std::vector<std::int64_t> periods_ns;
  for (std::size_t i = 1; i < times_ns.size(); ++i) periods_ns.push_back(times_ns[i] - times_ns[i - 1]);
  std::sort(periods_ns.begin(), periods_ns.end());
  if (periods_ns.empty()) return;
  const auto median_ns = static_cast<double>(periods_ns[periods_ns.size() / 2]);
  if (median_ns > 0) info.fps = std::clamp(1e9 / median_ns, kMinHz, kMaxHz);
}

RecordingSource::RecordingSource(std::string uri, std::unique_ptr<Recording> recording, const RecordingOptions& options)
    : recording_(std::move(recording)), frames_(assemble(*recording_, options)) {
  info_ = frames_->info();
  info_.uri = std::move(uri);
  first_ = read_next();
  if (!first_) throw SourceError("no usable frame in " + recording_->name() + skips_.summary());
}

std::optional<SourceFrame> RecordingSource::next() {
  std::optional<SourceFrame> frame = first_ ? std::exchange(first_, std::nullopt) : read_next();
  if (frame) skips_.number(*frame);
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
