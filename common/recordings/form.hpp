// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "common/io/byte_source.hpp"

namespace rtd::recordings {

/// What a file of a recording is.
enum class Form {
  kMcap,
  kBag,     ///< of ROS 1
  kDb3,     ///< a database of rosbag2
  kPacked,  ///< with zstd, whatever it holds
  kOther,   ///< no recording
};

/// By how it begins. An MCAP file whose first bytes are damaged is known by the header behind them.
Form form_of(const io::ByteSource& source);

/// The same of a file. kOther for a folder and for what cannot be read.
Form form_of(const std::filesystem::path& path);

}  // namespace rtd::recordings
