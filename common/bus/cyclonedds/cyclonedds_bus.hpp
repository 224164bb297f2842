// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bus/raw_bus.hpp"

namespace rtd::bus::cyclonedds {

/// Both throw BusError when Cyclone DDS cannot start.
std::shared_ptr<BusBackend> create_backend(const BusOptions& options);
std::shared_ptr<RawBus> create_raw_bus(const BusOptions& options);

}  // namespace rtd::bus::cyclonedds
