// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "common/service/config.hpp"

namespace rtd::service {

/// How a process joins the bus, as said on the command line: the same options for every service and `rtd run`.
/// Empty and -1: not said.
struct BusArguments {
  std::string profile;  ///< name of a built-in profile or a YAML file
  std::vector<std::string> peers, interfaces;
  std::string discovery_server;
  std::string vendor;
  int domain = -1;
  bool secure = false;
  std::string keystore;  ///< names the keystore and means --secure
};

void add_bus_options(CLI::App& app, BusArguments& arguments);

/// Where the values of a configuration come from, beside the command line's own options.
struct ConfigSources {
  std::string file;                    ///< --config
  std::vector<std::string> overrides;  ///< --set
};

/// In rising priority: defaults, profile, environment, file, --set, own options. The binder needs the section `bus`.
/// Throws ConfigError, for an unknown profile with the names of those there are.
void load_config(ConfigBinder& binder, const BusArguments& arguments, const ConfigSources& sources);

/// The words that give another process the same arguments.
std::vector<std::string> to_words(const BusArguments& arguments);

}  // namespace rtd::service
