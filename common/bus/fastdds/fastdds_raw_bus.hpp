// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/bus/raw_bus.hpp"

namespace rtd::bus::fastdds {

/// A participant of its own: Fast DDS allows one type support for each type name in a participant. Hears Cyclone DDS
/// over UDP too. Throws BusError.
std::shared_ptr<RawBus> create_raw_bus(const BusOptions& options);

}  // namespace rtd::bus::fastdds
