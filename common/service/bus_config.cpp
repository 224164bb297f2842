// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/bus_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <ranges>

#include "common/bus/host/ring_folder.hpp"
#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "common/io/printable.hpp"
#include "common/msg/services.hpp"
#include "common/security/keystore_layout.hpp"
#include "common/service/dds_environment.hpp"
#include "common/service/model_locator.hpp"

namespace rtd::service {
namespace {

std::string profile_names() {
  return fmt::format("{}", fmt::join(std::views::keys(built_in_profiles()), ", "));
}

bool is_file_name(const std::string& profile) {
  return profile.find('/') != std::string::npos || profile.ends_with(".yaml") || profile.ends_with(".yml");
}

/// Once: it belongs to both groups of options.
void add_profile_option(CLI::App& app, ConfigSources& sources) {
  constexpr const char* kFlag = "--profile";
  if (app.get_option_no_throw(kFlag) != nullptr) return;
  app.add_option(kFlag, sources.profile,
                 fmt::format("Network profile: {}, or a YAML file (default: localhost)", profile_names()))
      ->group("Network");
}

void load_profile(ConfigBinder& binder, const std::string& profile) {
  if (profile.empty()) return;
  if (const auto known = built_in_profiles().find(profile); known != built_in_profiles().end())
    return binder.load_text(known->second, "config/profiles/" + profile + ".yaml", config_sections());
  std::string cause = io::abridged(profile) + ": no such profile";
  try {
    if (is_file_name(profile))
      return binder.load_text(io::read_file(profile, io::kSettings), profile, config_sections());
  } catch (const io::IoError& error) {
    cause = error.what();
  }
  throw ConfigError(fmt::format("--profile {}, there are {} (or a YAML file)", cause, profile_names()));
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

/// As the ROS 2 has it that is set up in this shell.
std::string ros_graph_of_environment() {
  const std::string distribution = process_environment()("ROS_DISTRO").value_or("");
  constexpr std::array kUpToHumble = {"foxy", "galactic", "humble"};
  return std::ranges::count(kUpToHumble, distribution) > 0 ? "humble" : "iron";
}

}  // namespace

bus::BusOptions to_bus_options(const BusConfig& config, const std::string& participant_name) {
  bus::BusOptions options = config.options;
  options.participant_name = participant_name;
  if (options.ros_graph == "auto") options.ros_graph = ros_graph_of_environment();
  options.security = security_options(config.security, participant_name, options.robot);
  options.rings = process_environment()(bus::kRingsVariable).value_or("");
  if (options.vendor != "inprocess") options.environment = follow_dds_environment(process_environment(), options);
  return options;
}

void add_source_options(CLI::App& app, ConfigSources& sources) {
  app.add_option("--config", sources.file, "YAML file with a section per service");
  app.add_option("--set", sources.overrides, "Override one key, e.g. --set filter.mode=geometry (repeatable)");
  add_profile_option(app, sources);
}

void add_bus_options(CLI::App& app, ConfigSources& sources) {
  BusConfig config;
  ConfigBinder binder;
  binder.section("bus", config);
  add_profile_option(app, sources);
  binder.add_options(app, sources.given);
}

void load_config(ConfigBinder& binder, const ConfigSources& sources) {
  load_profile(binder, sources.profile);
  apply_environment(binder);
  if (!sources.file.empty()) binder.load_file(sources.file, config_sections());
  for (const std::string& assignment : sources.overrides) binder.set(assignment, config_sections());
  for (const GivenOption& option : sources.given) {
    binder.set(option);
    if (option.key == "bus.security.keystore") binder.set("bus.security.enabled", "true", option.flag);
  }
}

std::vector<std::string> to_command_line(const ConfigSources& sources) {
  std::vector<std::string> line;
  if (!sources.profile.empty()) line.insert(line.end(), {"--profile", sources.profile});
  if (!sources.file.empty()) line.insert(line.end(), {"--config", sources.file});
  for (const std::string& assignment : sources.overrides) line.insert(line.end(), {"--set", assignment});
  for (const std::string& word : to_command_line(sources.given, "bus")) line.push_back(word);
  return line;
}

bus::BusOptions load_bus_options(const ConfigSources& sources, const std::string& participant_name) {
  BusConfig config;
  ConfigBinder binder;
  binder.section("bus", config);
  load_config(binder, sources);
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
