// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/doctor/doctor_command.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "common/bus/network.hpp"
#include "common/bus/port_check.hpp"
#include "common/security/enclave.hpp"

namespace rtd::launcher {
namespace {

/// camera, detector, filter, slam, dense, record and rtd itself.
constexpr int kProcessesOfRun = 7;

/// Whether the kernel has a route there; sends nothing.
bool has_route(const std::string& address) {
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (probe < 0) return true;
  sockaddr_in target{};
  target.sin_family = AF_INET;
  target.sin_port = htons(bus::discovery_port(0));
  inet_pton(AF_INET, address.c_str(), &target.sin_addr);
  const bool unreachable =
      connect(probe, reinterpret_cast<const sockaddr*>(&target), sizeof(target)) != 0 && errno == ENETUNREACH;
  close(probe);
  return !unreachable;
}

Finding interfaces(const bus::NetworkOptions& network) {
  try {
    if (network.loopback_only) return {Verdict::kOk, "network: this host only; --profile lan or wifi adds other hosts"};
    return {Verdict::kOk, fmt::format("network: {} besides loopback, {}", fmt::join(interface_addresses(network), ", "),
                                      network.multicast ? "multicast" : "no multicast: each process must name a peer")};
  } catch (const bus::BusError& error) {
    return {Verdict::kFail, std::string("network: ") + error.what()};
  }
}

Finding named_host(const std::string& host, const std::string& option) {
  try {
    const std::string address = bus::resolve_host(host, option).address;
    if (has_route(address)) return {Verdict::kOk, fmt::format("network: {} {} is {}", option, host, address)};
    return {Verdict::kFail, fmt::format("network: {} {}: no route to {}; connect this host to its network (ip route)",
                                        option, host, address)};
  } catch (const bus::BusError& error) {
    return {Verdict::kFail, std::string("network: ") + error.what()};
  }
}

/// Settings that contradict each other: outside peers with loopback only, a server with the wrong vendor.
void contradictions(const bus::BusOptions& options, Findings& findings) {
  try {
    bus::require_network(options);
  } catch (const bus::BusError& error) {
    const std::string text = std::string("network: ") + error.what();
    for (const Finding& known : findings)
      if (known.text == text) return;
    findings.push_back({Verdict::kFail, text});
  }
}

Finding participant_ports(std::uint32_t domain) {
  const int free = bus::free_participant_ports(domain);
  const std::string text =
      fmt::format("ports: {} of {} from UDP {} on are free; each process of DDS domain {} needs one", free,
                  bus::kPeerParticipants, bus::participant_port(domain, 0), domain);
  if (free >= kProcessesOfRun) return {Verdict::kOk, text};
  return {
      free == 0 ? Verdict::kFail : Verdict::kWarn,
      text + fmt::format(
                 "; a run needs up to {}: list the programs that hold them with 'ss -ulpn', or choose another --domain",
                 kProcessesOfRun)};
}

void ports(const bus::BusOptions& options, Findings& findings) {
  if (options.network.multicast) {
    try {
      bus::require_discovery_port(options.domain);
      findings.push_back({Verdict::kOk, fmt::format("ports: UDP {} is shared by all of DDS domain {}",
                                                    bus::discovery_port(options.domain), options.domain)});
    } catch (const bus::BusError& error) {
      findings.push_back({Verdict::kFail, std::string("ports: ") + error.what()});
    }
  }
  if (bus::takes_participant_port(options)) findings.push_back(participant_ports(options.domain));
}

constexpr std::int64_t kDayS = 24 * 3600, kWarnDays = 30;  // as in the services
const std::vector<std::string> kServices = {"/rtd/camera", "/rtd/detector", "/rtd/filter",  "/rtd/slam",
                                            "/rtd/dense",  "/rtd/record",   "/rtd/launcher"};

/// The enclaves that can join; findings about the others.
std::vector<security::Enclave> usable(const bus::BusOptions& options, const std::vector<std::string>& names,
                                      std::int64_t now_s, Findings& findings) {
  std::vector<security::Enclave> good;
  for (const std::string& name : names) {
    try {
      good.push_back(security::open_enclave(options.security.keystore, name, static_cast<int>(options.domain), now_s));
    } catch (const security::SecurityError& error) {
      findings.push_back({Verdict::kFail, std::string("keystore: ") + error.what()});
    }
  }
  return good;
}

void report_missing(const std::vector<std::string>& there, Findings& findings) {
  std::vector<std::string> missing;
  for (const std::string& service : kServices)
    if (std::ranges::count(there, service) == 0) missing.push_back(service);
  if (missing.empty()) return;
  findings.push_back(
      {Verdict::kWarn, fmt::format("keystore: no enclave {}, so it cannot run on this host; if it should, "
                                   "copy it here from the keystore where it was made",
                                   fmt::join(missing, ", "))});
}

}  // namespace

void check_network(const bus::BusOptions& options, Findings& findings) {
  const bus::NetworkOptions& network = options.network;
  findings.push_back(interfaces(network));
  for (const std::string& peer : network.peers) findings.push_back(named_host(peer, "--peers"));
  if (!network.discovery_server.empty()) findings.push_back(named_host(network.discovery_server, "--discovery-server"));
  for (const bus::EnvironmentSetting& setting : options.environment)
    findings.push_back({setting.followed ? Verdict::kOk : Verdict::kWarn, "network: " + setting.text});
  contradictions(options, findings);
  ports(options, findings);
}

std::string check_keystore(const bus::BusOptions& options, std::int64_t now_s, Findings& findings) {
  const std::string& folder = options.security.keystore;
  const security::KeystoreLayout layout{folder};
  std::error_code error;
  if (!std::filesystem::is_directory(layout.enclaves(), error)) {
    findings.push_back(
        {Verdict::kFail, fmt::format("keystore: {} is not a keystore: make one with 'rtd keystore create "
                                     "{}', or choose another with --keystore",
                                     folder, folder)});
    return {};
  }
  const std::vector<std::string> names = security::enclaves_in(layout);
  const std::vector<security::Enclave> good = usable(options, names, now_s, findings);
  report_missing(names, findings);
  if (good.empty()) {
    findings.push_back({Verdict::kFail, fmt::format("keystore: {} has no enclave that can join DDS domain {}: 'rtd "
                                                    "keystore info {}'",
                                                    folder, options.domain, folder)});
    return {};
  }
  const auto first = std::ranges::min_element(good, {}, &security::Enclave::valid_until_s);
  const std::int64_t days = (first->valid_until_s() - now_s) / kDayS;
  findings.push_back(
      {days < kWarnDays ? Verdict::kWarn : Verdict::kOk,
       fmt::format("keystore: {}, {} enclaves; {} is the first to expire, in {} days{}", folder, good.size(),
                   first->name, days, days < kWarnDays ? fmt::format(": 'rtd keystore renew {}'", folder) : "")});
  const auto requested = std::ranges::find(good, options.security.enclave, &security::Enclave::name);
  return requested != good.end() ? requested->name : good.front().name;
}

void describe_cameras(const std::vector<camera::FoundCamera>& cameras, Findings& findings) {
  using camera::Stream;
  for (const camera::FoundCamera& found : cameras) {
    const std::string name = fmt::format("camera: --source {} ({})", found.uri, found.name);
    const std::string modes = fmt::format("colour {}; depth {}", list_modes(found.modes, Stream::kColor),
                                          list_modes(found.modes, Stream::kDepth));
    if (found.problem.empty()) {
      findings.push_back({Verdict::kOk, name + ": " + modes});
    } else if (found.modes.empty()) {
      findings.push_back({Verdict::kWarn, name + ": " + found.problem});
    } else {
      findings.push_back({Verdict::kOk, name + ": not usable alone, " + found.problem + "; " + modes});
    }
  }
  if (cameras.empty()) {
    const std::string openni2 = camera::supports_openni2()
                                    ? " and openni2"
                                    : ", but not openni2 (libopenni2-dev was missing when it was built)";
    findings.push_back(
        {Verdict::kOk, "cameras: none is plugged in; this build supports ROS 2 topics, realsense-dds" + openni2});
  }
}

std::string why_no_camera(const std::string& scheme, const std::string& device,
                          const std::vector<camera::FoundCamera>& cameras) {
  const std::string uri = scheme + ":" + device;
  const auto is_it = [&](const camera::FoundCamera& found) {
    return device.empty() ? found.problem.empty() : found.uri == uri;
  };
  const auto found = std::ranges::find_if(cameras, is_it);
  if (found != cameras.end() && found->problem.empty()) return {};
  Findings findings;
  describe_cameras(cameras, findings);
  std::string text = "--source '" + uri + "': the camera cannot be used, 'rtd doctor' says:";
  for (const Finding& finding : findings) text += "\n  " + finding.text;
  return text;
}

}  // namespace rtd::launcher
