// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "common/bus/raw_bus.hpp"

namespace rtd::bus::fastdds {

/// What discovery finds of a participant.
struct FoundParticipant {
  enum class Change { kAppeared, kChanged, kGone };
  Change change = Change::kAppeared;
  ParticipantId id{};
  std::string name;
  std::array<std::uint8_t, 2> vendor{};
};

/// What the listener of either version receives, in the words of the bus. Called by discovery's threads.
class DiscoveryEvents {
 public:
  virtual ~DiscoveryEvents() = default;
  virtual void found(const FoundParticipant& participant) = 0;
  /// It did not authenticate itself.
  virtual void refused(const ParticipantId& /*participant*/) {}
  virtual void found(const TopicWriter& writer, bool gone) = 0;
  virtual void found(const TopicReader& reader, bool gone) = 0;
};

}  // namespace rtd::bus::fastdds
