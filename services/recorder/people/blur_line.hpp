// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "services/recorder/core/message_queue.hpp"
#include "services/recorder/core/topic_registry.hpp"
#include "services/recorder/people/people_blur.hpp"

namespace rtd::recorder {

/// Messages on their way into a recording without people. They keep their order; all wait while the first one is an
/// image whose detections may still come, for ten seconds or 128 MiB at most. For one thread. "Now" is any steadily
/// growing time.
class BlurLine {
 public:
  explicit BlurLine(const TopicRegistry& book) : book_(book) {}

  void push(QueuedMessage message, std::int64_t now_ns);
  /// The next message, blurred; empty when there is none or it waits. `ended`: nothing more comes.
  std::optional<QueuedMessage> pop(std::int64_t now_ns, bool ended = false);
  const PeopleBlur& people() const { return people_; }

 private:
  static constexpr std::int64_t kPatienceNs = 10'000'000'000;  ///< of a slow run, too
  static constexpr std::uint64_t kMostBytes = 128 * 1024 * 1024;
  static constexpr std::size_t kMostBatches = 1000;

  struct Waiting {
    QueuedMessage message;
    std::int64_t since_ns = 0;
  };

  const BlurTopic& topic(std::size_t index);
  bool must_wait(const Waiting& first, std::int64_t now_ns);

  const TopicRegistry& book_;
  std::vector<BlurTopic> topics_;  ///< as the registry has them
  PeopleBlur people_{kMostBatches};
  std::deque<Waiting> waiting_;
  std::uint64_t bytes_ = 0;
};

}  // namespace rtd::recorder
