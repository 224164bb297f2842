// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/auxiliary_topics.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "common/msg/imu.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::camera {
namespace {

using recordings::RecordedMessage;

std::int64_t stamp_of(const RecordedMessage& message) {
  return msg::to_ns(ros::decode<msg::Header>(message.wire, message.bytes).stamp);
}

/// Decoded in any case: what cannot be read is of no use to others.
template <class Message>
void make_cdr(RecordedMessage& message) {
  const auto decoded = ros::decode<Message>(message.wire, message.bytes);
  if (message.wire != ros::Wire::kCdr) message.bytes = ros::encode<ros::Wire::kCdr>(decoded);
  message.wire = ros::Wire::kCdr;
}

void to_cdr(RecordedMessage& message) {
  message.type == "nav_msgs/Odometry" ? make_cdr<msg::Odometry>(message) : make_cdr<msg::Imu>(message);
}

void add_transforms(recordings::Reader& recording, const std::vector<std::string>& topics, msg::TFMessage& lasting) {
  if (topics.empty()) return;
  std::set<std::string> known;
  for (const auto& transform : lasting.transforms) known.insert(transform.child_frame_id);
  recording.play(topics);
  while (const std::optional<RecordedMessage> message = recording.next()) {
    try {
      for (auto& transform : ros::decode<msg::TFMessage>(message->wire, message->bytes).transforms) {
        if (known.insert(transform.child_frame_id).second) lasting.transforms.push_back(std::move(transform));
      }
    } catch (const ros::WireError&) {
      continue;
    }
  }
}

}  // namespace

AuxiliaryTopics::AuxiliaryTopics(std::unique_ptr<recordings::Reader> recording, const std::vector<std::string>& topics)
    : recording_(std::move(recording)) {
  for (const std::string& topic : topics) newest_ns_[topic] = std::numeric_limits<std::int64_t>::min();
  ended_ = topics.empty();
  if (!ended_) recording_->play(topics);
}

bool AuxiliaryTopics::complete(std::int64_t stamp_ns) const {
  const auto reached = [stamp_ns](const auto& topic) { return topic.second >= stamp_ns; };
  const auto far_ahead = [stamp_ns](const auto& topic) { return topic.second > stamp_ns + kAheadNs; };
  return std::ranges::all_of(newest_ns_, reached) || std::ranges::any_of(newest_ns_, far_ahead);
}

std::vector<RecordedMessage> AuxiliaryTopics::until(std::int64_t stamp_ns) {
  std::vector<RecordedMessage> messages;
  while (!ended_ && !complete(stamp_ns)) {
    std::optional<RecordedMessage> message = recording_->next();
    ended_ = !message;
    if (ended_) break;
    try {
      const std::int64_t message_ns = stamp_of(*message);
      newest_ns_[message->topic] = message_ns;
      if (!begun_ && message_ns < stamp_ns - kBeforeNs) continue;
      to_cdr(*message);
      messages.push_back(std::move(*message));
    } catch (const ros::WireError&) {
      ++unreadable_;
    }
  }
  begun_ = true;
  return messages;
}

msg::TFMessage lasting_transforms(recordings::Reader& recording) {
  std::vector<std::string> lasting, others;
  for (const recordings::RecordedTopic& topic : recording.topics()) {
    if (recordings::is_tf(topic)) (topic.name.ends_with("tf_static") ? lasting : others).push_back(topic.name);
  }
  msg::TFMessage transforms;
  add_transforms(recording, lasting, transforms);
  add_transforms(recording, others, transforms);
  return transforms;
}

}  // namespace rtd::camera
