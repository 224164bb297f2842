// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/bus/raw_bus.hpp"

namespace rtd::topics {

/// The rate of a stream of messages. Times are of any monotonic clock.
struct Rate {
  std::uint64_t messages = 0, bytes = 0, lost = 0;
  double hz = 0;  ///< from the periods between messages; 0 for fewer than two messages
  double mean_ms = 0, deviation_ms = 0, shortest_ms = 0, longest_ms = 0;
};

/// Measures the periods between the messages of a topic, without keeping them.
class RateMeter {
 public:
  void add(std::int64_t received_ns, std::size_t bytes);
  void add_lost(std::uint64_t count) { lost_ += count; }
  std::uint64_t messages() const { return messages_; }
  Rate rate() const;

 private:
  std::uint64_t messages_ = 0, bytes_ = 0, lost_ = 0;
  std::int64_t last_ns_ = 0, shortest_ns_ = 0, longest_ns_ = 0;
  double mean_ns_ = 0, squares_ns2_ = 0;  ///< Welford's running mean and sum of squared deviations
};

/// A topic and its writers.
struct TopicRow {
  bus::RawTopic topic;  ///< of its first writer
  std::vector<bus::TopicWriter> writers;
  Rate rate;  ///< `hz` only
};

/// Sorted by name; another type on the same name has its own row.
std::vector<TopicRow> rows_of(const std::vector<bus::TopicWriter>& writers);

/// The topics of a domain as a table, and as JSON with everything that writers announce.
std::string list_text(const std::vector<TopicRow>& rows);
nlohmann::ordered_json list_json(const std::vector<TopicRow>& rows);

/// Their measured rates.
std::string rate_text(const std::vector<TopicRow>& rows, double seconds);
nlohmann::ordered_json rate_json(const std::vector<TopicRow>& rows, double seconds);

enum class Detail {
  kReadable,  ///< for people: times as dates, six digits behind the point, "[36 x 0]" for an array of one value
  kAll,
};

/// A message (common/ros2/message_json.hpp) as YAML: one line per field, arrays of values in one line, "---" at
/// the end.
std::string message_text(const nlohmann::ordered_json& message, Detail detail = Detail::kAll);

}  // namespace rtd::topics
