// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/mcap/records.hpp"

namespace rtd::recordings {

/// A piece of a payload, the 4-byte CDR header included.
struct ByteRange {
  std::size_t begin = 0, end = 0;
};

/// Where a message says when or by which process it was made: the fields that differ between two runs on the same
/// input. By the name in the schema: "rtd_msgs::msg::dds_::FeatureFrame_" or "rtd_msgs/msg/FeatureFrame".
std::vector<ByteRange> run_ranges(const std::string& type);

/// What differs between two payloads of one type, a line for each field: name, how many values, the first two. Payloads
/// of an unknown type: the first byte that differs.
std::vector<std::string> differences(const std::string& type, io::ByteView a, io::ByteView b);

}  // namespace rtd::recordings
