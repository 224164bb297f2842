// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/service/bus_config.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/runtime.hpp"
#include "common/service/service_lock.hpp"
#include "services/link/core/link_rules.hpp"
#include "services/link/one_way.hpp"

namespace CLI {
class App;
}

namespace rtd::link {

/// Section `link` of the configuration.
struct ServiceConfig {
  int fleet_domain = -1;  ///< -1: not given
  std::vector<std::string> topics = default_rules();
  std::string fleet_profile, fleet_discovery_server, fleet_dds;
  std::vector<std::string> fleet_peers, fleet_interfaces;

  void bind(auto& binder) {
    binder.field("fleet_domain", fleet_domain, {-1, 232}, "DDS domain of the fleet").option("--fleet");
    binder
        .field(
            "topics", topics,
            "topics or patterns that pass to the fleet, e.g. '/slam/*'; with in: in front to the robot, e.g. in:/goal")
        .option("--topics");
    binder.field("fleet_profile", fleet_profile, "network profile of the fleet's side; empty: localhost")
        .option("--fleet-profile");
    binder.field("fleet_peers", fleet_peers, "hosts of the fleet that are asked directly, e.g. gpubox")
        .option("--fleet-peers");
    binder.field("fleet_interfaces", fleet_interfaces, "network interfaces to the fleet; none: all")
        .option("--fleet-interface");
    binder
        .field("fleet_discovery_server", fleet_discovery_server,
               "HOST:PORT of a Fast DDS Discovery Server of the fleet")
        .option("--fleet-discovery-server");
    binder.field("fleet_dds", fleet_dds, "DDS implementation of the fleet's side; empty: the robot's")
        .option("--fleet-dds");
  }
};

/// rtd-link: one participant in the robot's domain and one in the fleet's, and an allow-list between them. Robots do
/// not discover each other's every endpoint then. Its heartbeat counts what passes.
class LinkService {
 public:
  static constexpr const char* kName = "link";
  static constexpr const char* kDescription =
      "Pass a robot's poses, images and detections to and from a fleet's domain";
  using Config = ServiceConfig;
  static void add_options(CLI::App& app, std::vector<service::GivenOption>& given);

  /// Joins both domains. Throws ConfigError and BusError.
  LinkService(const Config& config, service::Runtime& runtime);
  service::ExitCode run();

 private:
  void report(std::int64_t now_ns);

  const Config config_;
  service::Runtime& runtime_;
  const LinkRules rules_;
  const service::ServiceLock only_one_;  ///< of this robot in the fleet, from whichever domain
  std::shared_ptr<bus::RawBus> robot_, fleet_;
  std::optional<OneWay> to_fleet_, to_robot_;
  std::int64_t started_ns_ = 0, reported_ns_ = 0;
  std::uint64_t reported_bytes_ = 0;
  bool waiting_logged_ = false;
};

}  // namespace rtd::link
