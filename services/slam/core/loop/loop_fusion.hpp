// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/slam/core/loop/place_verification.hpp"

namespace rtd::slam {

/// Joins the landmarks of a keyframe and its neighbours with those of the place it was found at; both stand where they
/// belong already. First those that the meeting found, then by projection. Returns how many landmarks were joined or
/// gained an observation. docs/theory/loop_closing.md, "Fusion".
int fuse_place(Map& map, KeyframeId keyframe, const PlaceMeeting& meeting, int neighbours);

}  // namespace rtd::slam
