// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/bus_config.hpp"

#include <cstdlib>

namespace rtd::service {

void BusConfig::bind(ConfigBinder& binder) {
  binder.field("vendor", vendor, "DDS implementation (--dds, RTD_DDS)");
  binder.field("domain", domain, {0, 232}, "DDS domain (--domain, ROS_DOMAIN_ID)");
  binder.field("shm_segment_mib", shm_segment_mib, {8, 1024}, "shared-memory segment of each process");
  binder.field("socket_buffer_kib", socket_buffer_kib, {64, 65536}, "wanted UDP buffers, capped by the kernel");
  binder.field("loopback_only", loopback_only, "false: also use the host's network interfaces");
}

void apply_bus_environment(ConfigBinder& binder) {
  if (const char* vendor = std::getenv("RTD_DDS")) binder.set("bus.vendor", vendor, "environment RTD_DDS");
  if (const char* domain = std::getenv("ROS_DOMAIN_ID")) binder.set("bus.domain", domain, "environment ROS_DOMAIN_ID");
}

bus::BusOptions to_bus_options(const BusConfig& config, const std::string& participant_name) {
  bus::BusOptions options;
  options.vendor = config.vendor;
  options.domain = static_cast<std::uint32_t>(config.domain);
  options.participant_name = participant_name;
  options.shm_segment_mib = static_cast<std::uint32_t>(config.shm_segment_mib);
  options.socket_buffer_kib = static_cast<std::uint32_t>(config.socket_buffer_kib);
  options.network.loopback_only = config.loopback_only;
  return options;
}

const std::vector<std::string>& config_sections() {
  static const std::vector<std::string> kSections = {"bus",   "camera", "detector", "filter",  "slam",
                                                     "dense", "record", "replay",   "launcher"};
  return kSections;
}

}  // namespace rtd::service
