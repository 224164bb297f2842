// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace rtd::bus {

/// How a process joins the bus. Defaults: Fast DDS, loopback only.
struct BusOptions {
  std::string vendor = "fastdds";          ///< "fastdds" or "inprocess"; `--dds`, RTD_DDS
  std::uint32_t domain = 0;                ///< DDS domain 0..232; `--domain`, ROS_DOMAIN_ID
  std::string participant_name;            ///< shown by DDS tools, e.g. "rtd-filter"
  std::uint32_t shm_segment_mib = 16;      ///< shared-memory segment of this process, >= 8
  std::uint32_t socket_buffer_kib = 4096;  ///< asked UDP buffer, capped by net.core.rmem_max
  bool loopback_only = true;               ///< false: also the host's network interfaces
};

/// Connects to the bus. Throws BusError: unknown vendor (with the list of those built in), domain out of range,
/// /dev/shm too small (with size and fix), participant refused.
std::shared_ptr<Bus> connect(const BusOptions& options);

/// Names accepted as BusOptions::vendor in this build.
std::vector<std::string> available_vendors();

}  // namespace rtd::bus
