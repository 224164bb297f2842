// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "common/bus/bus_factory.hpp"
#include "common/camera/frame_source.hpp"

namespace rtd::camera {

/// The source of a running camera (is_live()): ROS 2 topics on the bus, or a device. `on_wait` receives what it waits
/// for. Throws SourceError: URI, calibration file, no support in this build; BusError when the bus refuses.
std::unique_ptr<FrameSource> make_live_source(const std::string& uri, const bus::BusOptions& bus,
                                              std::int64_t open_timeout_ns,
                                              std::function<void(const std::string&)> on_wait);

}  // namespace rtd::camera
