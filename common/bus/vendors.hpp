// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bus/raw_bus.hpp"
#include "common/bus/ros_graph.hpp"

/// The entry of each vendor, defined where the build has it. Throw BusError with cause and fix.
namespace rtd::bus {

/// Shared memory and UDP. `node`: endpoints of the node that the connection belongs to, its own by default.
namespace fastdds {
std::shared_ptr<BusBackend> create_backend(const BusOptions& options, std::shared_ptr<NodeEndpoints> node = nullptr);
/// A participant of its own: Fast DDS allows one type support for each type name in a participant. Also matches
/// writers and readers of Cyclone DDS, over UDP.
std::shared_ptr<RawBus> create_raw_bus(const BusOptions& options);
}  // namespace fastdds

namespace cyclonedds {
std::shared_ptr<BusBackend> create_backend(const BusOptions& options, std::shared_ptr<NodeEndpoints> node = nullptr);
std::shared_ptr<RawBus> create_raw_bus(const BusOptions& options);
}  // namespace cyclonedds

}  // namespace rtd::bus
