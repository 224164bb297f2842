// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "common/bus/raw_bus.hpp"

namespace rtd::bus::inprocess {

/// Raw endpoints of one process among themselves, for component tests: discovery, reliability, durability and keep-last
/// histories behave as over DDS.
std::shared_ptr<RawBus> create_raw_bus(std::uint32_t domain);

}  // namespace rtd::bus::inprocess
