// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/recordings/reader.hpp"
#include "services/evaluation/core/integrity/published_pose.hpp"
#include "services/evaluation/core/trajectory/recorded_poses.hpp"

namespace rtd::eval {

/// The results of slam in a recording (topic rtd/tracking), one for each frame, in the order of their stamps.
struct RecordedResults {
  std::vector<PublishedPose> published;
  std::vector<std::string> damages;  ///< what could not be read, one line each
};

/// The topic that is chosen, if it has results of slam.
std::optional<std::string> topic_of_results(const recordings::Reader& recording, const PoseChoice& choice);

RecordedResults read_recorded_results(recordings::Reader& recording, const std::string& topic);

}  // namespace rtd::eval
