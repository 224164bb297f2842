// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"

namespace rtd::bus {

/// What the host gives to shared memory and sockets, in bytes. 0 = could not be read: nothing is concluded from it.
struct HostLimits {
  std::uint64_t shm_total = 0;
  std::uint64_t shm_free = 0;
  std::uint64_t rmem_max = 0;  ///< net.core.rmem_max
  std::uint64_t wmem_max = 0;  ///< net.core.wmem_max
  /// Ports of Fast DDS in shared memory that belong to another user, and who that is: one of the two may not open what
  /// the other one sends there, and no error says so.
  std::map<std::uint32_t, std::uint32_t> closed_ports = {};
};

/// Reads the limits of this host. The paths are for tests.
HostLimits read_host_limits(const std::string& shm_dir = "/dev/shm",
                            const std::string& sysctl_dir = "/proc/sys/net/core");

/// Throws BusError, naming size and fix, when the free shared memory cannot hold this process's segment and the frames
/// of one writer. Without this check Fast DDS dies later with SIGBUS, because segments are over-committed.
void require_shared_memory(const BusOptions& options, const HostLimits& limits);

/// Why samples of a host go over UDP although BusOptions::shared_memory is set: programs of another user are in the
/// domain. One line with what helps; empty when there are none.
std::string why_not_shared_memory(const BusOptions& options, const HostLimits& limits);

/// What may cost frames on this host, one line each with the command that cures it; empty when all is well.
std::vector<std::string> host_warnings(const BusOptions& options, const HostLimits& limits = read_host_limits());

/// The buffer to ask of a socket: as requested, but not above what the kernel grants (`limit` 0 = unknown).
std::uint32_t socket_buffer_bytes(std::uint32_t requested_kib, std::uint64_t limit);

}  // namespace rtd::bus
