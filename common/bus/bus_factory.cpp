// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/bus_factory.hpp"

#include <utility>

#include "common/bus/host/port_check.hpp"
#include "common/bus/network.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/bus/security_guard.hpp"
#include "common/bus/vendors.hpp"
#include "common/msg/word_list.hpp"

namespace rtd::bus {
namespace {

constexpr std::uint32_t kMaxDomain = 232;  // above it the RTPS port numbers leave 16 bits

struct Vendor {
  const char* name;
  std::shared_ptr<BusBackend> (*create)(const BusOptions&);
  std::shared_ptr<RawBus> (*create_raw)(const BusOptions&);
  bool secures;  ///< honours BusOptions::security
};

/// A new vendor is a folder beside this file and one entry here. The first one is the default.
const Vendor kVendors[] = {
#ifdef RTD_HAVE_FASTDDS
    {"fastdds", fastdds::create_backend, fastdds::create_raw_bus, true},
#endif
#ifdef RTD_HAVE_CYCLONEDDS
    {"cyclonedds", cyclonedds::create_backend, cyclonedds::create_raw_bus, true},
#endif
    {"inprocess", inprocess::create_backend, inprocess::create_raw_bus, false},
};

std::string join_names(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) joined += (joined.empty() ? "" : ", ") + name;
  return joined;
}

/// Throws BusError: no such vendor, a domain out of range, a network that cannot be, no port free.
const Vendor& vendor_of(const BusOptions& options) {
  require_robot_name(options.robot);
  if (options.domain > kMaxDomain) {
    throw BusError("domain " + std::to_string(options.domain) + " is out of range, allowed: 0.." +
                   std::to_string(kMaxDomain) + " (--domain, ROS_DOMAIN_ID)");
  }
  for (const Vendor& vendor : kVendors) {
    if (options.vendor != vendor.name) continue;
    if (options.vendor != "inprocess") require_network(options);
    if (options.security.enabled() && !vendor.secures)
      throw BusError("bus '" + options.vendor +
                     "' knows no DDS-Security: leave --secure out or choose another (--dds)");
    if (options.iceoryx && options.vendor != "cyclonedds") {
      throw BusError("bus.iceoryx is a way of Cyclone DDS: add --dds cyclonedds, or leave it out (" + options.vendor +
                     " needs no daemon for its shared memory)");
    }
    if (options.vendor == "inprocess") return vendor;
    if (options.network.multicast) require_discovery_port(options.domain);
    if (takes_participant_port(options)) require_participant_port(options.domain);
    return vendor;
  }
  throw BusError("unknown bus '" + options.vendor + "', this build has: " + join_names(available_vendors()) +
                 " (--dds, RTD_DDS)");
}

}  // namespace

std::string default_vendor() {
  return kVendors[0].name;
}

std::string vendor_names() {
  return msg::word_list(dds_vendors());
}

std::vector<std::string> available_vendors() {
  std::vector<std::string> names;
  for (const Vendor& vendor : kVendors) names.emplace_back(vendor.name);
  return names;
}

std::vector<std::string> dds_vendors() {
  std::vector<std::string> names = available_vendors();
  std::erase(names, "inprocess");
  return names;
}

std::shared_ptr<Bus> connect(const BusOptions& options) {
  const Vendor& vendor = vendor_of(options);
  if (!options.security.enabled()) return std::make_shared<Bus>(vendor.create(options), options.robot);
  security::Enclave enclave = require_enclave(options);
  return std::make_shared<Bus>(guard(vendor.create(options), std::move(enclave)), options.robot);
}

std::shared_ptr<RawBus> connect_raw(const BusOptions& options) {
  const Vendor& vendor = vendor_of(options);
  if (!options.security.enabled()) return vendor.create_raw(options);
  security::Enclave enclave = require_enclave(options);
  return guard(vendor.create_raw(options), std::move(enclave));
}

}  // namespace rtd::bus
