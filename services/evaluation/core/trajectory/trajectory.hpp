// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/geometry/trajectory.hpp"
#include "common/io/text.hpp"

namespace rtd::eval {

using geometry::read_frame_stamps;
using geometry::read_tum_trajectory;
using geometry::StampedPose;
using geometry::stamps_of;
using geometry::Trajectory;
using geometry::TrajectoryError;
using io::parse_stamp_ns;

}  // namespace rtd::eval
