// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/bus_factory.hpp"

#include <mutex>
#include <optional>
#include <utility>

#include "common/bus/network.hpp"
#include "common/bus/port_check.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/bus/security_guard.hpp"
#include "common/bus/vendors.hpp"
#include "common/io/printable.hpp"
#include "common/msg/word_list.hpp"

namespace rtd::bus {
namespace {

constexpr std::uint32_t kMaxDomain = 232;  // above it the RTPS port numbers leave 16 bits

#if defined(RTD_HAVE_FASTDDS) && defined(RTD_HAVE_CYCLONEDDS)
/// A connection to Cyclone DDS that offers services through Fast DDS, from the first one on: Cyclone DDS cannot send
/// what clients of rmw_fastrtps know their replies by, while Fast DDS answers clients of both.
class ServesBoth : public BusBackend {
 public:
  explicit ServesBoth(const BusOptions& options)
      : BusBackend(options.vendor), own_(cyclonedds::create_backend(options, node_)), options_(options) {
    options_.vendor = "fastdds";
    options_.shared_memory = false;
    options_.ros_graph = "off";  // own_ announces the node of both
  }
  std::unique_ptr<WriterBackend> create_writer(MessageId id, const std::string& topic, QosProfile profile,
                                               StatusCallbacks callbacks) override {
    return own_->create_writer(id, topic, profile, std::move(callbacks));
  }
  std::unique_ptr<ReaderBackend> create_reader(MessageId id, const std::string& topic, QosProfile profile,
                                               ErasedCallback on_message, StatusCallbacks callbacks) override {
    return own_->create_reader(id, topic, profile, std::move(on_message), std::move(callbacks));
  }
  std::unique_ptr<CallEndpoint> create_calls(const CallTopics& topics, CallRole role, OnCall on_call) override {
    if (role == CallRole::kClient) return own_->create_calls(topics, role, std::move(on_call));
    const std::lock_guard lock(mutex_);
    if (!serving_) serving_ = fastdds::create_backend(options_, node_);
    return serving_->create_calls(topics, role, std::move(on_call));
  }

 private:
  const std::shared_ptr<NodeEndpoints> node_ = std::make_shared<NodeEndpoints>();
  const std::shared_ptr<BusBackend> own_;
  BusOptions options_;  ///< of serving_
  std::mutex mutex_;
  std::shared_ptr<BusBackend> serving_;
};
#endif

#ifdef RTD_HAVE_CYCLONEDDS
/// A secured domain has one vendor only.
std::shared_ptr<BusBackend> create_cyclonedds(const BusOptions& options) {
#ifdef RTD_HAVE_FASTDDS
  if (!options.security.enabled()) return std::make_shared<ServesBoth>(options);
#endif
  return cyclonedds::create_backend(options);
}
#endif

/// A new vendor is a folder next to this file and one entry here. The first one is the default.
std::vector<Vendor>& vendors() {
  static std::vector<Vendor> all = {
#ifdef RTD_HAVE_FASTDDS
      {"fastdds", [](const BusOptions& options) { return fastdds::create_backend(options); }, fastdds::create_raw_bus,
       true},
#endif
#ifdef RTD_HAVE_CYCLONEDDS
      {"cyclonedds", create_cyclonedds, cyclonedds::create_raw_bus, true},
#endif
  };
  return all;
}

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
  for (const Vendor& vendor : vendors()) {
    if (options.vendor != vendor.name) continue;
    if (options.vendor != kInprocess) require_network(options);
    if (options.security.enabled() && !vendor.secures)
      throw BusError("bus '" + options.vendor +
                     "' knows no DDS-Security: leave --secure out or choose another (--dds)");
    if (options.vendor == kInprocess) return vendor;
    if (options.network.multicast) require_discovery_port(options.domain);
    if (takes_participant_port(options)) require_participant_port(options.domain);
    return vendor;
  }
  throw BusError("unknown bus '" + io::abridged(options.vendor) +
                 "', this build has: " + join_names(available_vendors()) + " (--dds, RTD_DDS)");
}

}  // namespace

void add_vendor(const Vendor& vendor) {
  vendors().push_back(vendor);
}

std::string default_vendor() {
  return vendors().empty() ? kInprocess : vendors().front().name;
}

std::string vendor_names() {
  return msg::word_list(dds_vendors());
}

std::vector<std::string> available_vendors() {
  std::vector<std::string> names;
  for (const Vendor& vendor : vendors()) names.emplace_back(vendor.name);
  return names;
}

std::vector<std::string> dds_vendors() {
  std::vector<std::string> names = available_vendors();
  std::erase(names, kInprocess);
  return names;
}

std::shared_ptr<Bus> connect(const BusOptions& options) {
  const Vendor& vendor = vendor_of(options);
  const auto traffic = options.traffic ? options.traffic : std::make_shared<Traffic>();
  if (!options.security.enabled()) return std::make_shared<Bus>(vendor.create(options), options.robot, traffic);
  security::Enclave enclave = require_enclave(options);
  return std::make_shared<Bus>(guard(vendor.create(options), std::move(enclave)), options.robot, traffic);
}

std::shared_ptr<RawBus> connect_raw(const BusOptions& options) {
  const Vendor& vendor = vendor_of(options);
  std::optional<security::Enclave> enclave;
  if (options.security.enabled()) enclave = require_enclave(options);
  std::shared_ptr<RawBus> bus = vendor.create_raw(options);
  if (enclave) bus = guard(std::move(bus), std::move(*enclave));
  bus->count_in(options.traffic);
  return bus;
}

}  // namespace rtd::bus
