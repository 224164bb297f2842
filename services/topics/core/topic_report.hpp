// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/bus/raw_bus.hpp"
#include "services/topics/core/rate_meter.hpp"

namespace rtd::topics {

/// A topic and its writers.
struct TopicRow {
  bus::RawTopic topic;  ///< of its first writer
  std::vector<bus::TopicWriter> writers;
  Rate rate;  ///< `hz` only
};

/// Sorted by name; another type on the same name has a row of its own.
std::vector<TopicRow> rows_of(const std::vector<bus::TopicWriter>& writers);

/// The topics of a domain as a table, and as JSON with everything that writers announce.
std::string list_text(const std::vector<TopicRow>& rows);
nlohmann::ordered_json list_json(const std::vector<TopicRow>& rows);

/// Their measured rates.
std::string rate_text(const std::vector<TopicRow>& rows, double seconds);
nlohmann::ordered_json rate_json(const std::vector<TopicRow>& rows, double seconds);

}  // namespace rtd::topics
