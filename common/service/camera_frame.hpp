// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/service/runtime.hpp"

namespace rtd::service {

/// What rtd-camera's heartbeat says about the frame of its images, so that all services name the one that their driver
/// does. `frame_id`: as it is on the wire; one that a heartbeat cannot carry becomes the usual one. Returns the name.
std::string announce_camera_frame(Heartbeat& heartbeat, const bus::Bus& bus, const std::string& frame_id);

/// The name on the wire: `configured`, else what rtd-camera says, else the usual one.
std::string camera_frame(const Heartbeat& heartbeat, const bus::Bus& bus, const std::string& configured = {});
/// Whether that is more than a guess.
bool knows_camera_frame(const Heartbeat& heartbeat, const std::string& configured = {});

}  // namespace rtd::service
