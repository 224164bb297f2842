// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/bus/bus_factory.hpp"

namespace rtd::bus::cyclonedds {

/// Throws BusError when Cyclone DDS cannot start.
std::shared_ptr<BusBackend> create_backend(const BusOptions& options);

}  // namespace rtd::bus::cyclonedds
