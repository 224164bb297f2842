// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bus/raw_bus.hpp"

namespace rtd::bus::fastdds {

/// Joins the domain with Fast DDS over shared memory and UDP. Throws BusError with cause and fix.
std::shared_ptr<BusBackend> create_backend(const BusOptions& options);

/// A participant of its own: Fast DDS allows one type support for each type name in a participant. Also matches
/// writers and readers of Cyclone DDS, over UDP. Throws BusError.
std::shared_ptr<RawBus> create_raw_bus(const BusOptions& options);

}  // namespace rtd::bus::fastdds
