// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "services/recorder/inspect/message_pairs.hpp"

namespace rtd::recording {

/// What does not count as a difference.
struct DiffOptions {
  bool ignore_run_fields = false;  ///< payload fields that say when or by which process a message was made
  bool ignore_stamps = false;      ///< publish times
};

/// A message that differs, told by where it is.
struct MessagePlace {
  std::size_t index_a = 0, index_b = 0;  ///< positions in the topic
  Fingerprint a, b;
  std::vector<std::string> why;  ///< fields that differ, filled by explain()
};

struct TopicDiff {
  std::string topic, type_a, type_b;
  std::size_t messages_a = 0, messages_b = 0;
  PairedBy paired_by = PairedBy::kPosition;
  std::size_t only_a = 0, only_b = 0;
  std::size_t payloads = 0;         ///< pairs whose payloads differ
  std::size_t run_fields_only = 0;  ///< of these, only in fields of the run
  std::size_t stamps = 0;           ///< pairs whose publish times differ
  /// How far the time between two messages in a row, by log_time, is from that in the other recording; no difference.
  double timing_p50_ms = 0, timing_p99_ms = 0;
  std::size_t out_of_order = 0;              ///< pairs that stand in another order
  std::optional<MessagePlace> first;         ///< the first payload that differs and counts
  std::optional<std::size_t> first_missing;  ///< position in A (or else in B) of the first without partner

  bool equal(const DiffOptions& options) const;
};

struct RecordingDiff {
  DiffOptions options;
  std::vector<TopicDiff> topics;  ///< by name
  bool equal() const;
};

/// Topic by topic. Order and contents are compared within a topic: between topics nothing orders messages.
RecordingDiff diff(const Contents& a, const Contents& b, const DiffOptions& options = {});

/// Reads the first payloads that differ from both files and says why.
void explain(RecordingDiff& diff, const mcap::ByteSource& a, const mcap::ByteSource& b);

std::string to_text(const RecordingDiff& diff);
nlohmann::ordered_json to_json(const RecordingDiff& diff);

}  // namespace rtd::recording
