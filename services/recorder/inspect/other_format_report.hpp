// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "services/recorder/inspect/recording_report.hpp"

namespace rtd::recordings {

/// The report on a ROS 1 bag or a rosbag2 database (sqlite3), which is read whole; empty for any other file. Throws
/// camera::SourceError when it cannot be used at all.
std::optional<RecordingReport> report_on_other_format(const std::filesystem::path& file);

}  // namespace rtd::recordings
