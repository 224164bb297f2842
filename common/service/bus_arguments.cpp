// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/bus_arguments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/service/bus_config.hpp"
#include "common/service/profiles.hpp"

namespace rtd::service {
namespace {

std::string profile_names() {
  std::string names;
  for (const auto& [name, text] : built_in_profiles()) names += (names.empty() ? "" : ", ") + name;
  return names;
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

}  // namespace

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
  app.add_flag("--secure", arguments.secure, "DDS-Security: only who has keys of the keystore (bus.security.enabled)");
  app.add_option("--keystore", arguments.keystore,
                 "Keystore of 'rtd keystore create', with --secure (RTD_KEYSTORE, ROS_SECURITY_KEYSTORE)");
}

void load_config(ConfigBinder& binder, const BusArguments& arguments, const ConfigSources& sources) {
  load_profile(binder, arguments.profile);
  apply_bus_environment(binder);
  if (!sources.file.empty()) binder.load_file(sources.file, config_sections());
  for (const std::string& assignment : sources.overrides) binder.set(assignment, config_sections());
  if (!arguments.peers.empty()) binder.set("bus.network.peers", yaml_list(arguments.peers), "--peers");
  if (!arguments.interfaces.empty())
    binder.set("bus.network.interfaces", yaml_list(arguments.interfaces), "--interface");
  if (!arguments.discovery_server.empty())
    binder.set("bus.network.discovery_server", "\"" + arguments.discovery_server + "\"", "--discovery-server");
  if (!arguments.vendor.empty()) binder.set("bus.vendor", arguments.vendor, "--dds");
  if (arguments.domain >= 0) binder.set("bus.domain", std::to_string(arguments.domain), "--domain");
  if (!arguments.keystore.empty()) binder.set("bus.security.keystore", "\"" + arguments.keystore + "\"", "--keystore");
  if (arguments.secure || !arguments.keystore.empty()) binder.set("bus.security.enabled", "true", "--secure");
}

std::vector<std::string> to_words(const BusArguments& arguments) {
  std::vector<std::string> words;
  const auto add = [&words](const char* option, const std::string& value) {
    if (!value.empty()) words.insert(words.end(), {option, value});
  };
  add("--profile", arguments.profile);
  add("--peers", fmt::format("{}", fmt::join(arguments.peers, ",")));
  add("--interface", fmt::format("{}", fmt::join(arguments.interfaces, ",")));
  add("--discovery-server", arguments.discovery_server);
  add("--dds", arguments.vendor);
  if (arguments.domain >= 0) add("--domain", std::to_string(arguments.domain));
  if (arguments.secure) words.emplace_back("--secure");
  add("--keystore", arguments.keystore);
  return words;
}

}  // namespace rtd::service
