// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/ros_codec/byte_cursor.hpp"

namespace rtd::rosbag1 {

using ros::Bytes;

/// The values of the field "op".
enum class Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7,
};

/// Seconds and nanoseconds, 4 bytes each.
inline std::int64_t read_time_ns(ros::ByteCursor& cursor) {
  const auto sec = cursor.read<std::uint32_t>();
  return std::int64_t{sec} * 1'000'000'000 + cursor.read<std::uint32_t>();
}

/// The header of a record: "name=value" fields, each behind its length.
class RecordHeader {
 public:
  /// Throws ros::WireError for fields that do not fill the bytes.
  explicit RecordHeader(Bytes bytes);

  std::optional<Op> op() const;
  /// A number or time of the record. Throws ros::WireError when the field is absent or of another size.
  template <class T>
  T number(const std::string& name) const {
    ros::ByteCursor cursor(field(name));
    const T value = cursor.read<T>();
    if (cursor.remaining() != 0) throw ros::WireError("field '" + name + "' has the wrong size");
    return value;
  }
  std::int64_t time_ns(const std::string& name) const;
  /// Empty when the field is absent.
  std::string text(const std::string& name) const;

 private:
  Bytes field(const std::string& name) const;
  std::map<std::string, Bytes, std::less<>> fields_;
};

}  // namespace rtd::rosbag1
