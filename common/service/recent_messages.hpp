// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace rtd::service {

/// The last messages about frames that a service wrote. At the paces that lose no frame a camera sends frames again
/// whose result does not come, as many as it has in flight: they get the same message again, and what was left behind
/// is never taken for a source that goes back in time. One thread.
template <class Message>
class RecentMessages {
 public:
  /// The memory of the oldest one, to be filled as the newest.
  Message& add() {
    std::rotate(messages_.begin(), messages_.end() - 1, messages_.end());
    if (!messages_.front()) messages_.front() = std::make_unique<Message>();
    return *messages_.front();
  }
  /// Of frame `seq` with this stamp; null when it is not kept.
  const Message* find(std::uint64_t seq, std::int64_t stamp_ns) const {
    const auto found = std::ranges::find_if(messages_, [&](const auto& message) {
      return message && message->seq == seq && message->stamp_ns == stamp_ns;
    });
    return found == messages_.end() ? nullptr : found->get();
  }
  /// Whether the frame, which is not kept, lies between the newest one and another: it was lost, and newer ones came
  /// before it. Of a source that went back in time the newest one is not newer.
  bool left_behind(std::uint64_t seq, std::int64_t stamp_ns) const {
    const auto& newest = messages_.front();
    if (!newest || newest->seq <= seq || newest->stamp_ns <= stamp_ns) return false;
    return std::ranges::any_of(
        messages_, [&](const auto& message) { return message && message->seq < seq && message->stamp_ns < stamp_ns; });
  }

 private:
  static constexpr std::size_t kKept = 6;  // more than a camera has in flight

  std::array<std::unique_ptr<Message>, kKept> messages_;  ///< newest first
};

}  // namespace rtd::service
