// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bus/raw_bus.hpp"

namespace rtd::bus::inprocess {

/// A bus inside this process: services in threads of one test see each other as over DDS, without sockets. Messages are
/// passed as shared pointers; a loaned message is never copied. Each reader has one thread.
std::shared_ptr<BusBackend> create_backend(std::uint32_t domain);

/// Raw endpoints of one process among themselves, for component tests: discovery, reliability, durability and keep-last
/// histories behave as over DDS.
std::shared_ptr<RawBus> create_raw_bus(std::uint32_t domain);

}  // namespace rtd::bus::inprocess
