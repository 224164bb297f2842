// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/recorded_results.hpp"

#include <algorithm>

#include "common/msg/tracking.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::eval {

std::optional<std::string> topic_of_results(const recordings::Reader& recording, const PoseChoice& choice) {
  const recordings::RecordedTopic* topic = recordings::topic_named(recording, choice.topic);
  if (topic == nullptr || topic->type != "rtd_msgs/TrackingResult") return std::nullopt;
  return topic->name;
}

RecordedResults read_recorded_results(recordings::Reader& recording, const std::string& topic) {
  constexpr std::size_t kMaxDamages = 20;
  RecordedResults results;
  const auto note = [&](const std::string& damage) {
    if (results.damages.size() < kMaxDamages) results.damages.push_back(recording.name() + ": " + damage);
  };
  recording.play({topic});
  while (const auto message = recording.next()) {
    try {
      results.published.push_back(published_pose(ros::decode<msg::TrackingResult>(message->wire, message->bytes)));
    } catch (const ros::WireError& error) {
      note("message recorded at " + std::to_string(message->recorded_ns) + " ns of " + topic + ": " + error.what());
    }
  }
  for (const std::string& damage : recording.take_damages()) note(damage);
  // A frame that was sent again has the same result again.
  std::ranges::stable_sort(results.published, {}, &PublishedPose::stamp_ns);
  const auto repeated = std::ranges::unique(results.published, {}, &PublishedPose::stamp_ns);
  results.published.erase(repeated.begin(), repeated.end());
  return results;
}

}  // namespace rtd::eval
