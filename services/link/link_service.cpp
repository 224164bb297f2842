// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/link/link_service.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "common/service/command_line.hpp"
#include "common/service/log.hpp"
#include "common/service/metric_names.hpp"
#include "common/service/monotonic_clock.hpp"

namespace rtd::link {
namespace {

using service::ConfigError;

constexpr std::chrono::milliseconds kTick{20};  // a robot whose box has just come waits for two of them
constexpr std::int64_t kReportPeriodNs = 5'000'000'000, kPatienceNs = 5'000'000'000;

LinkRules rules_of(const ServiceConfig& config, const service::Runtime& runtime) {
  if (runtime.bus.robot().empty())
    throw ConfigError("a link needs the robot's name: --robot NAME, as the robot's own services have it");
  if (config.fleet_domain < 0) throw ConfigError("name the domain of the fleet: --fleet DOMAIN (link.fleet_domain)");
  if (static_cast<std::uint32_t>(config.fleet_domain) == runtime.bus_options.domain)
    throw ConfigError(fmt::format("--fleet {0}: the robot is in domain {0} itself; give it another one with --domain",
                                  config.fleet_domain));
  try {
    return LinkRules(runtime.bus.robot(), config.topics);
  } catch (const RuleError& error) {
    throw ConfigError(error.what());
  }
}

bus::BusOptions robot_options(const service::Runtime& runtime) {
  bus::BusOptions options = runtime.bus_options;
  options.participant_name = "rtd-link-robot";
  return options;
}

/// The robot's, with its own network.
bus::BusOptions fleet_options(const ServiceConfig& config, const service::Runtime& runtime) {
  service::ConfigSources sources;
  sources.profile = config.fleet_profile;
  const auto give = [&sources](const char* key, const char* flag, const std::vector<std::string>& words) {
    if (!words.empty() && !words.front().empty()) sources.given.push_back({key, flag, words});
  };
  give("bus.network.peers", "--fleet-peers", config.fleet_peers);
  give("bus.network.interfaces", "--fleet-interface", config.fleet_interfaces);
  give("bus.network.discovery_server", "--fleet-discovery-server", {config.fleet_discovery_server});
  bus::BusOptions options = runtime.bus_options;
  options.network = service::load_bus_options(sources, "rtd-link").network;
  if (!config.fleet_dds.empty()) options.vendor = config.fleet_dds;
  options.domain = static_cast<std::uint32_t>(config.fleet_domain);
  options.participant_name = "rtd-link-" + runtime.bus.robot();
  return options;
}

}  // namespace

void LinkService::add_options(CLI::App& app, std::vector<service::GivenOption>&) {
  app.footer(
      "--domain, --profile, --dds and their like are those of the robot's own services. Heartbeats always pass.\n"
      "Example: rtd link --robot anna --domain 7 --fleet 0 --fleet-profile lan");
}

LinkService::LinkService(const Config& config, service::Runtime& runtime)
    : config_(config),
      runtime_(runtime),
      rules_(rules_of(config, runtime)),
      only_one_({"link", rules_.robot(), static_cast<std::uint32_t>(config.fleet_domain)}) {
  const bus::BusOptions fleet = fleet_options(config_, runtime_);
  robot_ = bus::connect_raw(robot_options(runtime_));
  fleet_ = bus::connect_raw(fleet);
  to_fleet_.emplace(*robot_, *fleet_, rules_, Direction::kToFleet);
  to_robot_.emplace(*fleet_, *robot_, rules_, Direction::kToRobot);
  SPDLOG_INFO("event=linked robot={} domain={} fleet_domain={} fleet_dds={}", rules_.robot(),
              runtime_.bus_options.domain, fleet.domain, fleet.vendor);
}

service::ExitCode LinkService::run() {
  started_ns_ = reported_ns_ = service::monotonic_ns();
  while (!runtime_.stop.wait_for(kTick)) {
    runtime_.heartbeat.tick();
    to_fleet_->tick();
    to_robot_->tick();
    report(service::monotonic_ns());
  }
  report(reported_ns_ + kReportPeriodNs);
  return service::kOk;
}

/// What has passed, in the status and, when something has, in the log.
void LinkService::report(std::int64_t now_ns) {
  std::uint64_t bytes = 0, lost = 0, topics = 0;
  std::string rates;
  for (const OneWay* way : {&*to_fleet_, &*to_robot_}) {
    for (const Passed& passed : way->passed()) {
      const bool own_side = way == &*to_fleet_;
      topics += rules_.is_heartbeat(passed.topic) ? 0 : 1;
      bytes += passed.bytes;
      lost += passed.lost;
      const char* const prefix = own_side ? service::metric::kOutPrefix : service::metric::kInPrefix;
      runtime_.heartbeat.set_metric(prefix + passed.topic, static_cast<double>(passed.messages));
      rates += fmt::format(" {}{}={}{}", own_side ? "" : "in:", passed.topic, passed.messages,
                           passed.wanted ? "" : "(unread)");
    }
  }
  runtime_.heartbeat.set_metric(service::metric::kBytes, static_cast<double>(bytes));
  runtime_.heartbeat.set_metric(service::metric::kLost, static_cast<double>(lost));
  if (topics == 0) {
    runtime_.heartbeat.set_state(msg::ServiceState::kReady, "waits for topics of robot " + rules_.robot());
    if (now_ns - started_ns_ > kPatienceNs && !std::exchange(waiting_logged_, true)) {
      SPDLOG_WARN(
          "event=waiting cause=\"robot {} has no topic that may pass in domain {}\" fix=\"start it with --robot "
          "{} --domain {}\"",
          rules_.robot(), runtime_.bus_options.domain, rules_.robot(), runtime_.bus_options.domain);
    }
    return;
  }
  runtime_.heartbeat.set_state(msg::ServiceState::kRunning,
                               fmt::format("links robot {} with domain {}", rules_.robot(), config_.fleet_domain));
  if (now_ns - reported_ns_ < kReportPeriodNs) return;
  const double seconds = static_cast<double>(now_ns - reported_ns_) * 1e-9;
  if (bytes != reported_bytes_)
    SPDLOG_INFO("event=passed rate=\"{}/s\" lost={} messages:{}",
                service::bytes_text(static_cast<std::uint64_t>(static_cast<double>(bytes - reported_bytes_) / seconds)),
                lost, rates);
  reported_ns_ = now_ns;
  reported_bytes_ = bytes;
}

}  // namespace rtd::link
