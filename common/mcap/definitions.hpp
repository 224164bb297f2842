// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>

#include "common/mcap/problem.hpp"
#include "common/mcap/records.hpp"

namespace rtd::mcap {

/// The schemas and channels of a file as they come, checked against each other.
class Definitions {
 public:
  explicit Definitions(Problems& problems) : problems_(problems) {}

  /// False, and a problem at `offset`: the record must not be used.
  bool accept(const Schema& schema, std::uint64_t offset);
  bool accept(const Channel& channel, std::uint64_t offset);
  bool accept(const Message& message, std::uint64_t offset);

  const std::map<SchemaId, Schema>& schemas() const { return schemas_; }
  const std::map<ChannelId, Channel>& channels() const { return channels_; }

 private:
  template <class Id, class R>
  bool keep(std::map<Id, R>& known, const R& record, const char* kind, std::uint64_t offset);

  Problems& problems_;
  std::map<SchemaId, Schema> schemas_;
  std::map<ChannelId, Channel> channels_;
};

}  // namespace rtd::mcap
