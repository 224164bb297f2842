// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/rosbag1/record.hpp"

#include <algorithm>

namespace rtd::rosbag1 {

RecordHeader::RecordHeader(Bytes bytes) {
  ros::ByteCursor cursor(bytes);
  while (cursor.remaining() > 0) {
    const Bytes entry = cursor.take(cursor.read<std::uint32_t>());
    const auto equals = std::find(entry.begin(), entry.end(), '=');
    if (equals == entry.end()) throw ros::WireError("a record's field has no '='");
    const auto name_length = static_cast<std::size_t>(equals - entry.begin());
    fields_[ros::to_text(entry.first(name_length))] = entry.subspan(name_length + 1);
  }
}

std::optional<Op> RecordHeader::op() const {
  const auto found = fields_.find("op");
  if (found == fields_.end() || found->second.size() != 1) return std::nullopt;
  return static_cast<Op>(found->second.front());
}

std::int64_t RecordHeader::time_ns(const std::string& name) const {
  ros::ByteCursor cursor(field(name));
  return read_time_ns(cursor);
}

std::string RecordHeader::text(const std::string& name) const {
  const auto found = fields_.find(name);
  return found == fields_.end() ? std::string() : ros::to_text(found->second);
}

Bytes RecordHeader::field(const std::string& name) const {
  const auto found = fields_.find(name);
  if (found == fields_.end()) throw ros::WireError("a record lacks its field '" + name + "'");
  return found->second;
}

}  // namespace rtd::rosbag1
