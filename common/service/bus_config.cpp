// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/bus_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <ranges>
#include <regex>
#include <sstream>

#include "common/bus/host/ring_folder.hpp"
#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "common/io/printable.hpp"
#include "common/msg/services.hpp"
#include "common/security/enclave.hpp"

namespace rtd::service {
namespace {

constexpr const char* kServer = "ROS_DISCOVERY_SERVER";
constexpr const char* kPeers = "ROS_STATIC_PEERS";
constexpr const char* kServerPort = "11811";  // of fast-discovery-server
constexpr std::size_t kMaxProfileBytes = 1U << 15;

/// "a;b;;c": empty parts stay, they count.
std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream words(text);
  for (std::string part; std::getline(words, part, ';');) {
    const std::size_t first = part.find_first_not_of(" \t"), last = part.find_last_not_of(" \t");
    parts.push_back(first == std::string::npos ? "" : part.substr(first, last - first + 1));
  }
  return parts;
}

bool on_this_host(const std::string& host) {
  return host.starts_with("127.") || host.starts_with("localhost");
}

/// Empty for one that ours cannot ask: over TCP or IPv6.
std::optional<std::string> server_address(std::string server) {
  for (const std::string scheme : {"UDPv4:", "udpv4:"}) {
    if (server.starts_with(scheme)) server = server.substr(scheme.size());
  }
  std::erase_if(server, [](char c) { return c == '[' || c == ']'; });
  const auto colons = std::ranges::count(server, ':');
  if (server.empty() || colons > 1 || server.find("TCP") != std::string::npos) return std::nullopt;
  return colons == 1 ? server : server + ':' + kServerPort;
}

constexpr const char* kNetwork = "--profile lan or wifi";

DdsSetting follow_server(const std::string& value, bus::BusOptions& options) {
  const std::string what = fmt::format("{}={}", kServer, value);
  std::string& server = options.network.discovery_server;
  if (!server.empty()) return {fmt::format("{}: --discovery-server {} is used instead", what, server), false};
  if (options.vendor != "fastdds") return {fmt::format("{}: only Fast DDS (--dds fastdds) can use one", what), false};
  const std::vector<std::string> servers = split(value);
  const auto named = std::ranges::count_if(servers, [](const std::string& part) { return !part.empty(); });
  if (named != 1 || servers.front().empty()) {
    return {fmt::format("{}: is not followed: one server with id 0 can be used, name it with --discovery-server "
                        "HOST:PORT",
                        what),
            false};
  }
  const std::optional<std::string> address = server_address(servers.front());
  if (!address) {
    return {fmt::format("{}: is not followed, write HOST:PORT (UDP over IPv4): --discovery-server HOST:PORT", what),
            false};
  }
  if (options.network.loopback_only && !on_this_host(*address)) {
    return {fmt::format("{}: is not followed, for only this host is used; {} follows it", what, kNetwork), false};
  }
  server = *address;
  return {fmt::format("{}: followed, as --discovery-server {}", what, server), true};
}

DdsSetting follow_peers(const std::string& value, bus::BusOptions& options) {
  const std::string what = fmt::format("{}={}", kPeers, value);
  std::vector<std::string> peers = split(value);
  std::erase(peers, "");
  bus::NetworkOptions& network = options.network;
  if (!network.peers.empty()) {
    return {fmt::format("{}: --peers {} are used instead", what, fmt::join(network.peers, ",")), false};
  }
  if (network.loopback_only && !std::ranges::all_of(peers, on_this_host)) {
    return {fmt::format("{}: is not followed, for only this host is used; {} follows it", what, kNetwork), false};
  }
  network.peers = peers;
  return {fmt::format("{}: followed, as --peers {}", what, fmt::join(peers, ",")), true};
}

std::string profile_text(const std::string& value) {
  if (value.find('<') != std::string::npos) return value;  // Cyclone DDS takes the text itself too
  const std::string scheme = "file://";
  const std::string file = value.starts_with(scheme) ? value.substr(scheme.size()) : value;
  return io::try_read_file(file, io::kSettings).value_or("").substr(0, kMaxProfileBytes);
}

/// The first group of each match, without doubles.
std::vector<std::string> found(const std::string& text, const char* pattern) {
  std::vector<std::string> values;
  const std::regex expression(pattern);
  for (std::sregex_iterator match(text.begin(), text.end(), expression), end; match != end; ++match) {
    const std::string value = (*match)[1];
    if (std::ranges::count(values, value) == 0) values.push_back(value);
  }
  return values;
}

/// What a profile says about hosts and interfaces, as our options; empty when it says nothing of them.
std::string as_options(const std::string& text) {
  const std::vector<std::string> peers = found(text, R"re(<Peer\s+[Aa]ddress="([^"]+)")re");
  std::vector<std::string> more = found(text, R"re(<udpv4>\s*(?:<port>[^<]*</port>\s*)?<address>\s*([^<\s]+))re");
  std::erase_if(more, [](const std::string& address) { return address.starts_with("239."); });  // multicast
  more.insert(more.begin(), peers.begin(), peers.end());
  std::vector<std::string> interfaces = found(text, R"re(<NetworkInterface\s[^>]*?(?:name|address)="([^"]+)")re");
  for (const auto& name : found(text, R"re(<interfaceWhiteList>\s*<address>\s*([^<\s]+)\s*</address>)re"))
    interfaces.push_back(name);
  std::string options;
  if (!more.empty()) options += fmt::format(" --peers {}", fmt::join(more, ","));
  if (!interfaces.empty()) options += fmt::format(" --interface {}", fmt::join(interfaces, ","));
  return options;
}

DdsSetting name_profile(const char* variable, const std::string& value) {
  const std::string shown = value.find('<') == std::string::npos ? value : "(text)";
  const std::string text = profile_text(value);
  if (text.empty()) return {fmt::format("{}={}: is not read here, and there is no such file", variable, shown), false};
  const std::string options = as_options(text);
  return {fmt::format("{}={}: is not read here, transports and QoS are rtd's own; {}", variable, shown,
                      options.empty() ? "hosts and interfaces: --peers, --interface, --profile"
                                      : "what it says about the network:" + options),
          false};
}

/// Ours is this host only unless a profile says otherwise. Where ROS 2 knows both variables, the older one wins.
std::optional<DdsSetting> compare_range(const EnvironmentReader& environment, const bus::BusOptions& options) {
  const std::string range = environment("ROS_AUTOMATIC_DISCOVERY_RANGE").value_or("");
  const bool localhost_only = environment("ROS_LOCALHOST_ONLY").value_or("") == "1";
  const std::string what = localhost_only ? "ROS_LOCALHOST_ONLY=1" : "ROS_AUTOMATIC_DISCOVERY_RANGE=" + range;
  const bool this_host = options.network.loopback_only;
  if (localhost_only || range == "LOCALHOST") {
    if (this_host) return DdsSetting{what + ": as here, this host only", true};
    return DdsSetting{what + ": ROS 2 programs with it stay on this host, while rtd uses the network", false};
  }
  if (range == "OFF") return DdsSetting{what + ": ROS 2 programs with it find no other one, rtd neither", false};
  if (range != "SUBNET") return std::nullopt;
  if (!this_host) return DdsSetting{what + ": as here, the network", true};
  return DdsSetting{
      fmt::format("{}: ROS 2 programs with it use the network, rtd only this host; {} uses it, too", what, kNetwork),
      false};
}

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

std::vector<DdsSetting> follow_dds_environment(const EnvironmentReader& environment, bus::BusOptions& options) {
  std::vector<DdsSetting> settings;
  const auto value_of = [&](const char* name) { return environment(name).value_or(""); };
  if (const std::string value = value_of(kServer); !value.empty()) settings.push_back(follow_server(value, options));
  if (const std::string value = value_of(kPeers); !value.empty()) settings.push_back(follow_peers(value, options));
  const std::vector<const char*> profiles =
      options.vendor == "cyclonedds"
          ? std::vector<const char*>{"CYCLONEDDS_URI"}
          : std::vector<const char*>{"FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE"};
  for (const char* profile : profiles) {
    if (const std::string value = value_of(profile); !value.empty()) settings.push_back(name_profile(profile, value));
  }
  if (const auto range = compare_range(environment, options)) settings.push_back(*range);
  return settings;
}

bus::BusOptions to_bus_options(const BusConfig& config, const std::string& participant_name) {
  bus::BusOptions options = config.options;
  options.participant_name = participant_name;
  if (options.ros_graph == "auto") options.ros_graph = ros_graph_of_environment();
  options.security = security_options(config.security, participant_name, options.robot);
  options.rings = process_environment()(bus::kRingsVariable).value_or("");
  if (options.vendor != bus::kInprocess) options.environment = follow_dds_environment(process_environment(), options);
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
