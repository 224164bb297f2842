// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/service/config.hpp"

namespace rtd::service {

/// bus.network: where a process looks for others. The profiles of config/profiles are sets of these.
struct NetworkConfig {
  bool loopback_only = bus::NetworkOptions{}.loopback_only;
  std::vector<std::string> interfaces;
  bool multicast = bus::NetworkOptions{}.multicast;
  std::vector<std::string> peers;
  std::string discovery_server;
  int max_datagram_bytes = static_cast<int>(bus::NetworkOptions{}.max_datagram_bytes);

  void bind(ConfigBinder& binder);
};

/// DDS-Security. Defaults: off; the keystore is found, the enclave named after the service.
struct SecurityConfig {
  bool enabled = false;
  std::string keystore, enclave;

  void bind(ConfigBinder& binder);
};

/// Settings of the bus as config keys; defaults come from BusOptions and the environment.
struct BusConfig {
  std::string vendor = bus::BusOptions{}.vendor;
  int domain = static_cast<int>(bus::BusOptions{}.domain);
  bool shared_memory = bus::BusOptions{}.shared_memory;
  int shm_segment_mib = static_cast<int>(bus::BusOptions{}.shm_segment_mib);
  int socket_buffer_kib = static_cast<int>(bus::BusOptions{}.socket_buffer_kib);
  bool iceoryx = bus::BusOptions{}.iceoryx;
  NetworkConfig network;
  SecurityConfig security;

  void bind(ConfigBinder& binder);
};

/// RTD_DDS and ROS_DOMAIN_ID, for a binder that has the section `bus`.
void apply_bus_environment(ConfigBinder& binder);
bus::BusOptions to_bus_options(const BusConfig& config, const std::string& participant_name);

/// The top-level sections of a configuration file; every process reads its own and `bus`.
const std::vector<std::string>& config_sections();

}  // namespace rtd::service
