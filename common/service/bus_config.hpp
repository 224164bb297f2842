// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/service/config.hpp"

namespace CLI {
class App;
}

namespace rtd::service {

/// bus.security. Defaults: off; the keystore is found, the enclave named after the service.
struct SecurityConfig {
  bool enabled = false;
  std::string keystore, enclave;

  void bind(auto& binder) {
    binder.field("enabled", enabled, "DDS-Security: only processes with keys of the keystore take part (--secure)");
    binder.field("keystore", keystore,
                 "folder of 'rtd keystore create' (--keystore, RTD_KEYSTORE, ROS_SECURITY_KEYSTORE), default "
                 "~/.config/rtd/keystore");
    binder.field("enclave", enclave, "whose keys: a path below enclaves/, default /rtd/ and the service's name");
  }
};

/// Section `bus` of the configuration.
struct BusConfig {
  bus::BusOptions options;
  SecurityConfig security;

  void bind(auto& binder) {
    options.bind(binder);
    binder.section("security", security);
  }
};

bus::BusOptions to_bus_options(const BusConfig& config, const std::string& participant_name);

/// The top-level sections of a configuration file; every process reads its own and `bus`.
const std::vector<std::string>& config_sections();

/// Text of config/profiles/<name>.yaml by name; compiled in, so that a bare executable knows them.
const std::map<std::string, std::string>& built_in_profiles();

/// How a process joins the bus, as given on the command line: the same options for every service and `rtd run`.
/// Empty and -1: not given.
struct BusArguments {
  std::string profile;  ///< name of a built-in profile or a YAML file
  std::vector<std::string> peers, interfaces;
  std::string discovery_server;
  std::string vendor;
  int domain = -1;
  std::string robot;
  bool secure = false;
  std::string keystore;  ///< names the keystore and means --secure
};

void add_bus_options(CLI::App& app, BusArguments& arguments);
/// The command line that gives another process the same arguments.
std::vector<std::string> to_command_line(const BusArguments& arguments);

/// Where the values of a configuration come from, beside the command line's own options.
struct ConfigSources {
  std::string file;                    ///< --config
  std::vector<std::string> overrides;  ///< --set
};

/// In rising priority: defaults, profile, environment, file, --set, own options. The binder needs the section `bus`.
/// Throws ConfigError, for an unknown profile with the names of the known ones.
void load_config(ConfigBinder& binder, const BusArguments& arguments, const ConfigSources& sources);
/// For a process that reads no other section than `bus`.
bus::BusOptions load_bus_options(const BusArguments& arguments, const ConfigSources& sources,
                                 const std::string& participant_name);

}  // namespace rtd::service
