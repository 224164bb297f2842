// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "services/camera/core/live/live_device.hpp"

namespace rtd::camera {

/// A RealSense camera that is on DDS itself (D555) or behind RealSense's adapter: it announces itself on
/// `realsense/device-info`, describes its streams on `TOPIC_ROOT/notification` and sends images while they are
/// subscribed. The connection is one of Fast DDS, whatever the vendor of the options. `serial`: empty for the only one
/// there is. Not opened; the connection to the domain stays until it is destroyed. Throws BusError when the bus
/// refuses.
std::unique_ptr<LiveDevice> make_realsense_device(const bus::BusOptions& options, const std::string& serial);

/// The cameras that announce themselves in the domain within a second, with their modes. Throws BusError.
std::vector<FoundCamera> find_realsense_cameras(const bus::BusOptions& options);

}  // namespace rtd::camera
