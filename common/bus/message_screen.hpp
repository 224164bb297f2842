// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/bus/message_types.hpp"
#include "common/bus/writer_id.hpp"
#include "common/msg/plausible.hpp"

namespace rtd::bus {

/// Whether the numbers of one writer's messages continue as a source counts them: they may go back, as in a loop, and
/// leave out what was lost, but not more than kMaxLost at a time. Remembers the last kMaxWriters. Not thread-safe.
class SequenceGuard {
 public:
  static constexpr std::uint64_t kMaxLost = 1'000'000;  ///< 9 hours at 30 Hz
  static constexpr std::size_t kMaxWriters = 16;

  /// A number that does not continue is not remembered.
  bool continues(const WriterId& writer, std::uint64_t sequence);

 private:
  struct Last {
    WriterId writer{};
    std::uint64_t sequence = 0;
    bool known = false;
  };
  std::array<Last, kMaxWriters> last_{};
  std::size_t oldest_ = 0;
};

/// What the edge of the bus asks about each message of one reader. Not thread-safe.
class MessageScreen {
 public:
  explicit MessageScreen(MessageId id) : id_(id) {}

  /// msg::implausible_field(), and for messages with a field `seq` that this is no jump.
  msg::ImplausibleField implausible_field(const void* message, const WriterId& writer);

 private:
  const MessageId id_;
  SequenceGuard sequences_;
};

}  // namespace rtd::bus
