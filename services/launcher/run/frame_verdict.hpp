// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/run_record/run_record.hpp"

namespace rtd::launcher {

/// Why frames of a run were not used: how many were, the commonest cause and what helps. `first_left_out`: the first
/// piece that the source left out, as the camera describes it; may be empty. Empty when nine of ten frames were used.
std::string why_not_used(const run_record::RunRecord& record, const std::string& first_left_out);

}  // namespace rtd::launcher
