// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/recorder/core/recording.hpp"

namespace rtd::recorder {

/// The text of rosbag2's metadata.yaml, version 5, which all its versions since ROS 2 Humble read. `names`: of the
/// files, relative to it.
std::string bag_metadata_text(const std::vector<std::string>& names, const std::vector<FileSummary>& files,
                              const std::vector<RecordedTopic>& topics);

}  // namespace rtd::recorder
