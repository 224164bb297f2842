// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/recording/recording_source.hpp"

#include <algorithm>
#include <utility>

namespace rtd::camera {

std::unique_ptr<FrameSource> open_recording(std::string uri, std::unique_ptr<recordings::Reader> recording,
                                            const RecordingOptions& options) {
  const bool named = !options.topics.color.empty() || !options.topics.depth.empty();
  if (!named && !own_frames_topic(*recording).empty()) return make_own_frames(std::move(uri), std::move(recording));
  return make_image_pairs(std::move(uri), std::move(recording), options);
}

RecordingSource::RecordingSource(std::string uri, std::unique_ptr<recordings::Reader> recording)
    : recording_(std::move(recording)) {
  info_.uri = std::move(uri);
}

void RecordingSource::describe_rate(const std::string& topic) {
  constexpr std::size_t kTimes = 16;  // each may have to be unpacked
  constexpr double kMinHz = 0.1, kMaxHz = 1000;
  info_.frames = topic_named(*recording_, topic)->messages;
  const std::vector<std::int64_t> times_ns = recording_->first_times_ns(topic, kTimes);
  std::vector<std::int64_t> periods_ns;
  for (std::size_t i = 1; i < times_ns.size(); ++i) periods_ns.push_back(times_ns[i] - times_ns[i - 1]);
  std::ranges::sort(periods_ns);
  if (periods_ns.empty()) return;
  const auto median_ns = static_cast<double>(periods_ns[periods_ns.size() / 2]);
  if (median_ns > 0) info_.fps = std::clamp(1e9 / median_ns, kMinHz, kMaxHz);
}

void RecordingSource::take_damages() {
  for (std::string& damage : recording_->take_damages()) skips_.add({SkipReason::kDamagedRecord, std::move(damage)});
}

}  // namespace rtd::camera
