// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/people/blur_line.hpp"

#include <memory>
#include <span>
#include <utility>

#include "common/recordings/reader.hpp"

namespace rtd::recorder {
namespace {

ros::Bytes bytes_of(const QueuedMessage& message) {
  const std::span<const std::byte> bytes = message.bytes->view();
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

}  // namespace

const BlurTopic& BlurLine::topic(std::size_t index) {
  while (topics_.size() <= index) {
    const RecordedTopic topic = book_.topic(topics_.size());
    topics_.push_back({topic.dds_name, recordings::plain_type(topic.dds_type)});
  }
  return topics_[index];
}

void BlurLine::push(QueuedMessage message, std::int64_t now_ns) {
  people_.learn(topic(message.topic), bytes_of(message));
  bytes_ += message.bytes->view().size();
  waiting_.push_back({std::move(message), now_ns});
}

bool BlurLine::must_wait(const Waiting& first, std::int64_t now_ns) {
  return now_ns - first.since_ns < kPatienceNs && bytes_ <= kMostBytes &&
         !people_.settled(topic(first.message.topic), bytes_of(first.message));
}

std::optional<QueuedMessage> BlurLine::pop(std::int64_t now_ns, bool ended) {
  while (!waiting_.empty() && (ended || !must_wait(waiting_.front(), now_ns))) {
    QueuedMessage message = std::move(waiting_.front().message);
    waiting_.pop_front();
    bytes_ -= message.bytes->view().size();
    const PeopleBlur::Result result = people_.apply(topic(message.topic), bytes_of(message));
    if (result.fate == Fate::kWithheld) continue;
    if (result.fate != Fate::kKept) {
      auto bytes = std::make_shared<bus::ByteBlock>();
      bytes->assign(std::as_bytes(std::span(result.cdr)));
      message.bytes = std::move(bytes);
    }
    return message;
  }
  return std::nullopt;
}

}  // namespace rtd::recorder
