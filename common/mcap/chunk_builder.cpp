// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/chunk_builder.hpp"

#include <algorithm>

namespace rtd::mcap {

void ChunkBuilder::add(const Message& message) {
  MessageIndex& index = indexes_[message.channel_id];
  index.channel_id = message.channel_id;
  index.records.emplace_back(message.log_time, records_.size());
  start_time_ = message_count_ == 0 ? message.log_time : std::min(start_time_, message.log_time);
  end_time_ = std::max(end_time_, message.log_time);
  ++message_count_;
  append_record(records_, message);
}

void ChunkBuilder::clear() {
  records_.clear();
  indexes_.clear();
  message_count_ = 0;
  start_time_ = end_time_ = 0;
}

}  // namespace rtd::mcap
