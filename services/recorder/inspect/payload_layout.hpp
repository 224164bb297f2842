// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/mcap/records.hpp"

namespace rtd::recording {

enum class FieldKind { kU8, kI16, kU16, kI32, kU32, kF32, kI64, kU64, kF64, kText };

/// A field of a message as XCDR1 has it: numbers aligned to their size, an array of them in a row.
struct Field {
  const char* name;
  FieldKind kind;
  std::uint32_t count = 1;
  /// Says when or by which process a message was made: differs between two runs on the same input.
  bool of_the_run = false;
};

/// Fields that stand `repeat` times in a row.
struct FieldGroup {
  std::vector<Field> fields;
  std::uint32_t repeat = 1;
};

/// A message type that this library can look into: our own ones and the poses.
struct PayloadLayout {
  const char* type;  ///< without its package: "FeatureFrame"
  std::vector<FieldGroup> groups;
};

/// Null for a type that is not known. Any spelling: "rtd_msgs/msg/FeatureFrame", "rtd_msgs::msg::dds_::FeatureFrame_".
const PayloadLayout* layout_of(const std::string& type);

/// A piece of a payload, the 4-byte CDR header included.
struct ByteRange {
  std::size_t begin = 0, end = 0;
};
/// Where the fields of the run stand; none of them stands behind a text.
std::vector<ByteRange> run_ranges(const PayloadLayout& layout);

/// What differs between two payloads of one type, a line for each field: name, how many values, the first two. Payloads
/// of a type without layout: the first byte that differs.
std::vector<std::string> differences(const PayloadLayout* layout, mcap::ByteView a, mcap::ByteView b);

}  // namespace rtd::recording
