// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace rtd::bus {

/// Where a process looks for others, and how its datagrams are cut. Defaults: what suits the loopback interface.
struct NetworkOptions {
  bool loopback_only = true;                 ///< false: also the host's network interfaces
  std::vector<std::string> interfaces;       ///< names or IPv4 addresses to use beside loopback; empty: all
  bool multicast = true;                     ///< false: only `peers` and the discovery server are asked
  std::vector<std::string> peers;            ///< host names or IPv4 addresses, `:PORT` where it is not the domain's own
  std::string discovery_server;              ///< HOST:PORT of a Fast DDS Discovery Server; empty: none
  std::uint32_t max_datagram_bytes = 65000;  ///< larger samples are cut by DDS; <= 1400 where packets may get lost
};

/// DDS-Security: a keystore in the layout of sros2, and whose keys to use. Both empty: plain DDS.
struct SecurityOptions {
  std::string keystore;  ///< folder with public/, private/, enclaves/
  std::string enclave;   ///< path below enclaves/, e.g. "/rtd/slam"
  bool enabled() const { return !keystore.empty(); }
};

/// Fast DDS where it is built in, else Cyclone DDS.
std::string default_vendor();

/// How a process joins the bus. Defaults: Fast DDS, loopback only.
struct BusOptions {
  std::string vendor = default_vendor();   ///< "fastdds", "cyclonedds" or "inprocess"; `--dds`, RTD_DDS
  std::uint32_t domain = 0;                ///< DDS domain 0..232; `--domain`, ROS_DOMAIN_ID
  std::string participant_name;            ///< shown by DDS tools, e.g. "rtd-filter"
  bool shared_memory = true;               ///< Fast DDS: false sends over UDP on one host too, where /dev/shm is tiny
  std::uint32_t shm_segment_mib = 16;      ///< shared-memory segment of this process, >= 8
  std::uint32_t socket_buffer_kib = 4096;  ///< asked UDP buffer, capped by net.core.rmem_max
  NetworkOptions network;
  SecurityOptions security;
  bool iceoryx = false;  ///< Cyclone DDS: fixed-size samples through a running iox-roudi
  /// Told in one line what keeps others from meeting us, e.g. a participant of another vendor in a secured domain.
  /// Runs on a bus thread, maybe several times: be brief, do not call the bus.
  std::function<void(const std::string& problem)> on_problem = {};
};

/// Connects to the bus. Throws BusError: unknown vendor (with the list of those built in), domain out of range,
/// /dev/shm too small (with size and fix), participant refused.
std::shared_ptr<Bus> connect(const BusOptions& options);

/// Names accepted as BusOptions::vendor in this build.
std::vector<std::string> available_vendors();
/// Those of them that go from process to process.
std::vector<std::string> dds_vendors();

}  // namespace rtd::bus
