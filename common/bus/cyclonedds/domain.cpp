// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/cyclonedds/domain.hpp"

#include <map>
#include <mutex>

#include "common/bus/cyclonedds/domain_config.hpp"
#include "common/bus/cyclonedds/iceoryx.hpp"
#include "common/bus/cyclonedds/vendor_log.hpp"

namespace rtd::bus::cyclonedds {
namespace {

std::mutex& domains_mutex() {
  static std::mutex mutex;
  return mutex;
}

std::shared_ptr<Domain> create_domain(const BusOptions& options, const std::string& config) {
  if (options.iceoryx) require_roudi();
  const LogCapture log;
  const dds_entity_t handle = dds_create_domain(options.domain, config.c_str());
  if (handle < 0) {
    throw BusError("Cyclone DDS refused to join domain " + std::to_string(options.domain) + " (" +
                   dds_strretcode(handle) + ")" + log.reason() +
                   "; is the interface up (ip link set lo up) and are fewer than 60 participants in this domain?");
  }
  return {new Domain{config, Entity(handle)}, [](Domain* domain) {
            const std::lock_guard lock(domains_mutex());  // nobody joins while it ends
            delete domain;
          }};
}

}  // namespace

std::shared_ptr<Domain> join_domain(const BusOptions& options) {
  static std::map<std::uint32_t, std::weak_ptr<Domain>> domains;  // Cyclone's own table is per process, too
  const std::string config = domain_config(options, read_host_limits());
  const std::lock_guard lock(domains_mutex());
  if (const auto known = domains[options.domain].lock()) {
    if (known->config == config) return known;
    throw BusError("this process is in domain " + std::to_string(options.domain) +
                   " with other network settings; Cyclone DDS allows one set of them for a domain and process");
  }
  const auto domain = create_domain(options, config);
  domains[options.domain] = domain;
  return domain;
}

}  // namespace rtd::bus::cyclonedds
