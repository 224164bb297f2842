// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mcap/encode.hpp"

namespace rtd::mcap {

/// The records of one chunk before it is compressed, and their index.
class ChunkBuilder {
 public:
  void add(const Schema& schema) { append_record(records_, schema); }
  void add(const Channel& channel) { append_record(records_, channel); }
  void add(const Message& message);

  bool empty() const { return records_.empty(); }
  std::uint64_t message_count() const { return message_count_; }
  ByteView records() const { return records_; }
  Timestamp start_time() const { return start_time_; }  ///< of its messages; 0 without any
  Timestamp end_time() const { return end_time_; }
  /// The entries of a channel in the order of the messages, as the conformance set has them.
  const std::map<ChannelId, MessageIndex>& indexes() const { return indexes_; }
  /// Keeps the memory.
  void clear();

 private:
  Bytes records_;
  std::map<ChannelId, MessageIndex> indexes_;
  std::uint64_t message_count_ = 0;
  Timestamp start_time_ = 0, end_time_ = 0;
};

}  // namespace rtd::mcap
