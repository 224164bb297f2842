// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/io/byte_source.hpp"
#include "common/mcap/problem.hpp"
#include "common/mcap/records.hpp"

namespace rtd::recordings {

/// Identifies a message without its payload.
struct Fingerprint {
  mcap::Timestamp log_ns = 0, publish_ns = 0;
  std::uint32_t sequence = 0;
  std::uint64_t bytes = 0;
  std::uint64_t hash = 0;         ///< of the payload
  std::uint64_t stable_hash = 0;  ///< of the payload without the fields of the run
  std::uint64_t key = 0;          ///< the first 8 bytes after the CDR header: our seq or the stamp of a ROS header
};

struct TopicContents {
  std::string type;
  std::set<std::string> encodings;    ///< of its channels: "cdr", "json", ...
  std::vector<Fingerprint> messages;  ///< in file order
};

struct Contents {
  std::map<std::string, TopicContents> topics;
  std::vector<mcap::Problem> problems;
  bool data_lost = false;
};

/// Reads a whole recording. `on_progress` gets the bytes read so far; may be empty.
Contents contents_of(const io::ByteSource& source, const std::function<void(std::uint64_t bytes)>& on_progress = {});

enum class PairedBy {
  kPublishTime,  ///< a recording of a replay
  kContent,      ///< another run on the same input: our seq, or the stamp of a ROS header
  kPosition,     ///< no better way: the first with the first
};
std::string name_of(PairedBy paired_by);

struct MessagePair {
  std::size_t a = 0, b = 0;  ///< positions in their topics
};

/// The messages of two recordings of a topic that correspond.
struct MessagePairs {
  PairedBy paired_by = PairedBy::kPosition;
  std::vector<MessagePair> pairs;  ///< in the order of A
  std::vector<std::size_t> only_a, only_b;
};

/// Uses the first way of PairedBy that pairs at least half of the messages of the shorter recording.
MessagePairs pair_messages(const TopicContents& a, const TopicContents& b);

/// What does not count as a difference.
struct DiffOptions {
  bool ignore_run_fields = false;  ///< payload fields that say when or by which process a message was made
  bool ignore_stamps = false;      ///< publish times
};

/// Where a message that differs is.
struct MessagePlace {
  std::size_t index_a = 0, index_b = 0;  ///< positions in the topic
  Fingerprint a, b;
  std::vector<std::string> why;  ///< fields that differ, filled by explain()
};

struct TopicDiff {
  std::string topic, type_a, type_b;
  std::string encoding_a, encoding_b;  ///< of the messages: "cdr"; several joined by a comma
  std::size_t messages_a = 0, messages_b = 0;
  PairedBy paired_by = PairedBy::kPosition;
  std::size_t only_a = 0, only_b = 0;
  std::size_t payloads = 0;         ///< pairs whose payloads differ
  std::size_t run_fields_only = 0;  ///< of these, only in fields of the run
  std::size_t stamps = 0;           ///< pairs whose publish times differ
  /// By how much the log_time between consecutive messages differs from the other recording; does not count as a
  /// difference.
  double timing_p50_ms = 0, timing_p99_ms = 0;
  std::size_t out_of_order = 0;              ///< pairs in another order
  std::optional<MessagePlace> first;         ///< the first payload that differs and counts
  std::optional<std::size_t> first_missing;  ///< position in A (or else in B) of the first message without a partner

  bool equal(const DiffOptions& options) const;
};

struct RecordingDiff {
  DiffOptions options;
  std::vector<TopicDiff> topics;  ///< by name
  bool equal() const;
};

/// Compares topic by topic: messages of different topics have no defined order.
RecordingDiff diff(const Contents& a, const Contents& b, const DiffOptions& options = {});

/// Reads the first differing payloads from both files and fills in why they differ.
void explain(RecordingDiff& diff, const io::ByteSource& a, const io::ByteSource& b);

std::string to_text(const RecordingDiff& diff);
nlohmann::ordered_json to_json(const RecordingDiff& diff);

}  // namespace rtd::recordings
