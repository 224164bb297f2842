// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "common/service/config.hpp"
#include "common/service/model_locator.hpp"

namespace CLI {
class App;
}

namespace rtd::service {

/// A variable that sets up the DDS of ROS 2 programs: a sentence that names it and its value.
using DdsSetting = bus::EnvironmentSetting;

/// Follows those variables that a user of ROS 2 has set and that can be followed, where none of our options says
/// otherwise: ROS_DISCOVERY_SERVER (Fast DDS) and ROS_STATIC_PEERS, unless they name other hosts while only this one is
/// used. Profiles of a vendor (FASTRTPS_DEFAULT_PROFILES_FILE, FASTDDS_DEFAULT_PROFILES_FILE, CYCLONEDDS_URI) are not
/// read, but what they say about hosts and interfaces is named as options. Returns what was set, in a fixed order.
std::vector<DdsSetting> follow_dds_environment(const EnvironmentReader& environment, bus::BusOptions& options);

/// bus.security. Defaults: off; the keystore is found, the enclave named after the service.
struct SecurityConfig {
  bool enabled = false;
  std::string keystore, enclave;

  void bind(auto& binder) {
    binder.field("enabled", enabled, "DDS-Security: only processes with keys of the keystore take part")
        .option("--secure", "Security");
    binder
        .field("keystore", keystore,
               "folder of 'rtd keystore create', means --secure; else RTD_KEYSTORE, ROS_SECURITY_KEYSTORE, "
               "~/.config/rtd/keystore")
        .option("--keystore", "Security");
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

/// Where the values of a configuration come from.
struct ConfigSources {
  std::string profile;                 ///< --profile: name of a built-in network profile or a YAML file
  std::string file;                    ///< --config
  std::vector<std::string> overrides;  ///< --set
  std::vector<GivenOption> given;      ///< options of the command line that are keys
};

/// --config, --set and --profile.
void add_source_options(CLI::App& app, ConfigSources& sources);
/// --profile and the options of section `bus`: how a process joins the bus.
void add_bus_options(CLI::App& app, ConfigSources& sources);
/// The command line that gives another process the same profile, file, --set and options of section `bus`.
std::vector<std::string> to_command_line(const ConfigSources& sources);

/// In rising priority: defaults, profile, environment, file, --set, own options. The binder needs the section `bus`.
/// Throws ConfigError, for an unknown profile with the names of the known ones.
void load_config(ConfigBinder& binder, const ConfigSources& sources);
/// For a process that reads no other section than `bus`; other options are passed over.
bus::BusOptions load_bus_options(const ConfigSources& sources, const std::string& participant_name);

}  // namespace rtd::service
