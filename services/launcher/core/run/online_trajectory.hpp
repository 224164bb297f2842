// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/evaluation/record/run_record.hpp"

namespace rtd::launcher {

/// The poses as they were published, one line per tracked frame in TUM's format: "stamp_s tx ty tz qx qy qz qw".
std::string online_trajectory_text(const std::vector<eval::FrameRecord>& frames);

}  // namespace rtd::launcher
