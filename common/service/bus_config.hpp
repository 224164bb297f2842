// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/service/config.hpp"

namespace rtd::service {

/// Settings of the bus as config keys; defaults come from BusOptions and the environment.
struct BusConfig {
  std::string vendor = bus::BusOptions{}.vendor;
  int domain = static_cast<int>(bus::BusOptions{}.domain);
  int shm_segment_mib = static_cast<int>(bus::BusOptions{}.shm_segment_mib);
  int socket_buffer_kib = static_cast<int>(bus::BusOptions{}.socket_buffer_kib);
  bool loopback_only = bus::NetworkOptions{}.loopback_only;

  void bind(ConfigBinder& binder);
};

/// RTD_DDS and ROS_DOMAIN_ID, for a binder that has the section `bus`.
void apply_bus_environment(ConfigBinder& binder);
bus::BusOptions to_bus_options(const BusConfig& config, const std::string& participant_name);

/// The top-level sections of a configuration file; every process reads its own and `bus`.
const std::vector<std::string>& config_sections();

}  // namespace rtd::service
