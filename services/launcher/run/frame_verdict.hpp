// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/run_record/run_record.hpp"

namespace rtd::launcher {

/// Whether frames are missing because camera, filter or slam died: what a running camera would have given meanwhile is
/// among them.
bool died_with_frames(const run_record::RunRecord& record);

/// Whether what the run gives is not that of its source: no more than half of the frames were used, a service died with
/// some, or those of a second camera were among them.
bool is_partial(const run_record::RunRecord& record);

/// Why frames of a run were not used: how many were, the service that died with them or the commonest cause, and what
/// helps. `first_left_out`: the first piece that the source left out, as the camera describes it; may be empty. Empty
/// when nine of ten frames were used, none died with a service and none are of a second camera.
std::string why_not_used(const run_record::RunRecord& record, const std::string& first_left_out);

}  // namespace rtd::launcher
