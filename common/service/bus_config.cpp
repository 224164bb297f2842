// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/bus_config.hpp"

#include <cstdlib>

#include "common/security/keystore_location.hpp"

namespace rtd::service {

void NetworkConfig::bind(ConfigBinder& binder) {
  binder.field("loopback_only", loopback_only, "false: also the host's network interfaces");
  binder.field("interfaces", interfaces, "names or IPv4 addresses to use beside loopback, none: all (--interface)");
  binder.field("multicast", multicast, "false: only peers and the discovery server are asked");
  binder.field("peers", peers, "hosts that are asked directly, HOST or HOST:PORT (--peers)");
  binder.field("discovery_server", discovery_server, "HOST:PORT of a Fast DDS Discovery Server (--discovery-server)");
  binder.field("max_datagram_bytes", max_datagram_bytes, {512, 65000}, "DDS cuts larger samples; 1400 on a network");
}

void SecurityConfig::bind(ConfigBinder& binder) {
  binder.field("enabled", enabled, "DDS-Security: only who has keys of the keystore takes part (--secure)");
  binder.field("keystore", keystore,
               "folder of 'rtd keystore create' (--keystore, RTD_KEYSTORE, ROS_SECURITY_KEYSTORE), default "
               "~/.config/rtd/keystore");
  binder.field("enclave", enclave, "whose keys: a path below enclaves/, default /rtd/ and the service's name");
}

void BusConfig::bind(ConfigBinder& binder) {
  binder.field("vendor", vendor, "DDS implementation (--dds, RTD_DDS)");
  binder.field("domain", domain, {0, 232}, "DDS domain (--domain, ROS_DOMAIN_ID)");
  binder.field("shared_memory", shared_memory, "false: Fast DDS sends over UDP on one host too");
  binder.field("shm_segment_mib", shm_segment_mib, {8, 1024}, "shared-memory segment of each process");
  binder.field("socket_buffer_kib", socket_buffer_kib, {64, 65536}, "wanted UDP buffers, capped by the kernel");
  binder.field("iceoryx", iceoryx, "Cyclone DDS: frames and features through a running iox-roudi");
  binder.section("network", network);
  binder.section("security", security);
}

void apply_bus_environment(ConfigBinder& binder) {
  if (const char* vendor = std::getenv("RTD_DDS")) binder.set("bus.vendor", vendor, "environment RTD_DDS");
  if (const char* domain = std::getenv("ROS_DOMAIN_ID")) binder.set("bus.domain", domain, "environment ROS_DOMAIN_ID");
  const char* const ros_security = std::getenv("ROS_SECURITY_ENABLE");  // ROS 2 compares exactly so
  if (ros_security != nullptr && std::string(ros_security) == "true")
    binder.set("bus.security.enabled", "true", "environment ROS_SECURITY_ENABLE");
}

namespace {

/// "rtd-slam" is the enclave /rtd/slam, the launcher "rtd" with its commands is /rtd/launcher.
bus::SecurityOptions security_options(const SecurityConfig& config, const std::string& participant_name) {
  if (!config.enabled) return {};
  const bool own = participant_name.starts_with("rtd-") && participant_name != "rtd-doctor";
  const std::string role = own ? participant_name.substr(4) : "launcher";
  return {config.keystore.empty() ? security::default_keystore() : config.keystore,
          config.enclave.empty() ? "/rtd/" + role : config.enclave};
}

}  // namespace

bus::BusOptions to_bus_options(const BusConfig& config, const std::string& participant_name) {
  bus::BusOptions options;
  options.vendor = config.vendor;
  options.domain = static_cast<std::uint32_t>(config.domain);
  options.participant_name = participant_name;
  options.shared_memory = config.shared_memory;
  options.shm_segment_mib = static_cast<std::uint32_t>(config.shm_segment_mib);
  options.socket_buffer_kib = static_cast<std::uint32_t>(config.socket_buffer_kib);
  options.iceoryx = config.iceoryx;
  options.network.loopback_only = config.network.loopback_only;
  options.network.interfaces = config.network.interfaces;
  options.network.multicast = config.network.multicast;
  options.network.peers = config.network.peers;
  options.network.discovery_server = config.network.discovery_server;
  options.network.max_datagram_bytes = static_cast<std::uint32_t>(config.network.max_datagram_bytes);
  options.security = security_options(config.security, participant_name);
  return options;
}

const std::vector<std::string>& config_sections() {
  static const std::vector<std::string> kSections = {"bus",   "camera", "detector", "filter",  "slam",
                                                     "dense", "record", "replay",   "launcher"};
  return kSections;
}

}  // namespace rtd::service
