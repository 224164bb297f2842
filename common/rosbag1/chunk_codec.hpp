// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/ros_codec/byte_cursor.hpp"

namespace rtd::rosbag1 {

/// The content of a chunk. `compression`: none, bz2 or lz4 (LZ4 frame format). `size` is what the chunk claims; memory
/// is taken as content appears, so that a false claim costs nothing. Throws ros::WireError: unknown compression (naming
/// it and those known), damaged data, another size than claimed.
std::vector<std::uint8_t> decompress(const std::string& compression, std::vector<std::uint8_t> data, std::size_t size);

}  // namespace rtd::rosbag1
