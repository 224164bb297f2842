// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "common/bus/qos.hpp"

namespace rtd::bus {

/// What went wrong on one topic since the connection began.
struct TopicTrouble {
  std::uint64_t lost = 0;              ///< samples that never came, or were overwritten before they were taken
  std::uint64_t rejected = 0;          ///< samples that did not fit into the history
  std::uint64_t incompatible_qos = 0;  ///< peers refused for their QoS
  std::uint64_t type_mismatch = 0;     ///< peers that use the name with another type
  std::string policy;                  ///< of the last peer refused, e.g. "RELIABILITY"
  std::string other_type;              ///< of the last mismatch
  friend bool operator==(const TopicTrouble&, const TopicTrouble&) = default;
};

/// Counts for each topic of one connection what its endpoints report. Thread-safe.
class TopicCounters {
 public:
  /// The callbacks of one endpoint, counted before they are called.
  StatusCallbacks count(const std::string& topic, StatusCallbacks callbacks);
  /// Topics with trouble, by name.
  std::map<std::string, TopicTrouble> troubles() const;

 private:
  struct Book {
    mutable std::mutex mutex;
    std::map<std::string, TopicTrouble> troubles;
  };
  std::shared_ptr<Book> book_ = std::make_shared<Book>();  ///< endpoints may report until they end
};

}  // namespace rtd::bus
