// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/bus_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ranges>

#include "common/msg/services.hpp"
#include "common/security/keystore_layout.hpp"

namespace rtd::service {
namespace {

std::string profile_names() {
  return fmt::format("{}", fmt::join(std::views::keys(built_in_profiles()), ", "));
}

bool is_file_name(const std::string& profile) {
  return profile.find('/') != std::string::npos || profile.ends_with(".yaml") || profile.ends_with(".yml");
}

void load_profile(ConfigBinder& binder, const std::string& profile) {
  if (profile.empty()) return;
  if (const auto known = built_in_profiles().find(profile); known != built_in_profiles().end())
    return binder.load_text(known->second, "config/profiles/" + profile + ".yaml", config_sections());
  std::ifstream file(profile);
  if (is_file_name(profile) && file && !std::filesystem::is_directory(profile))
    return binder.load_text({std::istreambuf_iterator<char>(file), {}}, profile, config_sections());
  throw ConfigError(fmt::format("--profile {}: {}, there are {} (or a YAML file)", profile,
                                is_file_name(profile) ? "no such file" : "no such profile", profile_names()));
}

/// ["a", "b:7410"]: quoted, for YAML reads colons.
std::string yaml_list(const std::vector<std::string>& values) {
  std::vector<std::string> quoted;
  for (const std::string& value : values) quoted.push_back(fmt::format("\"{}\"", value));
  return fmt::format("[{}]", fmt::join(quoted, ", "));
}

/// ROS 2 compares ROS_SECURITY_ENABLE exactly so.
void apply_environment(ConfigBinder& binder) {
  if (const char* vendor = std::getenv("RTD_DDS")) binder.set("bus.vendor", vendor, "environment RTD_DDS");
  if (const char* domain = std::getenv("ROS_DOMAIN_ID")) binder.set("bus.domain", domain, "environment ROS_DOMAIN_ID");
  if (const char* secure = std::getenv("ROS_SECURITY_ENABLE"); secure != nullptr && std::string(secure) == "true")
    binder.set("bus.security.enabled", "true", "environment ROS_SECURITY_ENABLE");
}

/// "rtd-slam" is the enclave /rtd/slam, of a robot with a name /rtd/NAME/slam; the launcher "rtd" with its commands is
/// /rtd/launcher.
bus::SecurityOptions security_options(const SecurityConfig& config, const std::string& participant_name,
                                      const std::string& robot) {
  if (!config.enabled) return {};
  const bool own = participant_name.starts_with("rtd-") && participant_name != "rtd-doctor";
  const std::string role = own ? participant_name.substr(4) : "launcher";
  return {config.keystore.empty() ? security::default_keystore() : config.keystore,
          config.enclave.empty() ? bus::enclave_of_robot(role, robot) : config.enclave};
}

}  // namespace

bus::BusOptions to_bus_options(const BusConfig& config, const std::string& participant_name) {
  bus::BusOptions options = config.options;
  options.participant_name = participant_name;
  options.security = security_options(config.security, participant_name, options.robot);
  return options;
}

void add_bus_options(CLI::App& app, BusArguments& arguments) {
  app.add_option("--profile", arguments.profile,
                 fmt::format("Network profile: {}, or a YAML file (default: localhost)", profile_names()));
  app.add_option("--peers", arguments.peers, "Hosts to ask directly, e.g. 192.168.1.20,gpubox (bus.network.peers)")
      ->delimiter(',');
  app.add_option("--interface", arguments.interfaces,
                 "Network interfaces to use, e.g. eth0 (bus.network.interfaces; default: all)")
      ->delimiter(',');
  app.add_option("--discovery-server", arguments.discovery_server,
                 "HOST:PORT of a Fast DDS Discovery Server (bus.network.discovery_server)");
  app.add_option("--dds", arguments.vendor,
                 fmt::format("DDS implementation: {} (RTD_DDS; default: {})", fmt::join(bus::dds_vendors(), " or "),
                             bus::default_vendor()));
  app.add_option("--domain", arguments.domain, "DDS domain 0..232 (ROS_DOMAIN_ID)");
  app.add_option("--robot", arguments.robot,
                 "Name of the robot, where several share a domain: its topics and frames are below it (bus.robot)");
  app.add_flag("--secure", arguments.secure,
               "DDS-Security: only processes with keys of the keystore take part (bus.security.enabled)");
  app.add_option("--keystore", arguments.keystore,
                 "Keystore of 'rtd keystore create', with --secure (RTD_KEYSTORE, ROS_SECURITY_KEYSTORE)");
}

void load_config(ConfigBinder& binder, const BusArguments& arguments, const ConfigSources& sources) {
  load_profile(binder, arguments.profile);
  apply_environment(binder);
  if (!sources.file.empty()) binder.load_file(sources.file, config_sections());
  for (const std::string& assignment : sources.overrides) binder.set(assignment, config_sections());
  if (!arguments.peers.empty()) binder.set("bus.network.peers", yaml_list(arguments.peers), "--peers");
  if (!arguments.interfaces.empty())
    binder.set("bus.network.interfaces", yaml_list(arguments.interfaces), "--interface");
  if (!arguments.discovery_server.empty())
    binder.set("bus.network.discovery_server", "\"" + arguments.discovery_server + "\"", "--discovery-server");
  if (!arguments.vendor.empty()) binder.set("bus.vendor", arguments.vendor, "--dds");
  if (arguments.domain >= 0) binder.set("bus.domain", std::to_string(arguments.domain), "--domain");
  if (!arguments.robot.empty()) binder.set("bus.robot", "\"" + arguments.robot + "\"", "--robot");
  if (!arguments.keystore.empty()) binder.set("bus.security.keystore", "\"" + arguments.keystore + "\"", "--keystore");
  if (arguments.secure || !arguments.keystore.empty()) binder.set("bus.security.enabled", "true", "--secure");
}

std::vector<std::string> to_command_line(const BusArguments& arguments) {
  std::vector<std::string> line;
  const auto add = [&line](const char* option, const std::string& value) {
    if (!value.empty()) line.insert(line.end(), {option, value});
  };
  add("--profile", arguments.profile);
  add("--peers", fmt::format("{}", fmt::join(arguments.peers, ",")));
  add("--interface", fmt::format("{}", fmt::join(arguments.interfaces, ",")));
  add("--discovery-server", arguments.discovery_server);
  add("--dds", arguments.vendor);
  if (arguments.domain >= 0) add("--domain", std::to_string(arguments.domain));
  add("--robot", arguments.robot);
  if (arguments.secure) line.emplace_back("--secure");
  add("--keystore", arguments.keystore);
  return line;
}

bus::BusOptions load_bus_options(const BusArguments& arguments, const ConfigSources& sources,
                                 const std::string& participant_name) {
  BusConfig config;
  ConfigBinder binder;
  binder.section("bus", config);
  load_config(binder, arguments, sources);
  return to_bus_options(config, participant_name);
}

const std::vector<std::string>& config_sections() {
  static const std::vector<std::string> kSections = [] {
    std::vector<std::string> names = msg::service_names();
    names.insert(names.end(), {"bus", "launcher"});
    return names;
  }();
  return kSections;
}

}  // namespace rtd::service
