// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/recorder/inspect/recording_contents.hpp"

namespace rtd::recording {

enum class PairedBy {
  kPublishTime,  ///< a recording of a replay
  kContent,      ///< another run on the same input: our seq, or the stamp of a ROS header
  kPosition,     ///< nothing better: the first with the first
};
std::string name_of(PairedBy paired_by);

struct MessagePair {
  std::size_t a = 0, b = 0;  ///< positions in their topics
};

/// Which messages of two recordings of a topic are the same one.
struct MessagePairs {
  PairedBy paired_by = PairedBy::kPosition;
  std::vector<MessagePair> pairs;  ///< in the order of A
  std::vector<std::size_t> only_a, only_b;
};

/// By the first of PairedBy that finds a partner for half of the messages of the shorter one.
MessagePairs pair_messages(const TopicContents& a, const TopicContents& b);

}  // namespace rtd::recording
