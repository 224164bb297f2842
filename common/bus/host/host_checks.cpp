// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/host/host_checks.hpp"

#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "common/bus/host/shm_names.hpp"
#include "common/bus/port_check.hpp"
#include "common/bus/qos.hpp"
#include "common/io/text.hpp"

namespace rtd::bus {
namespace {

constexpr std::uint64_t kKib = 1024, kMib = 1024 * kKib;
constexpr std::uint64_t kProcesses = 4;  // camera, detector, filter, slam

/// Shared memory of one writer of VGA frames: its history and the slot on loan, plus one for the pool's own
/// bookkeeping.
std::uint64_t frame_pool_bytes() {
  const auto depth = static_cast<std::uint64_t>(qos_settings(QosProfile::kRawFrame).depth);
  return (depth + 2) * sizeof(msg::RgbdFrame);
}

std::uint64_t round_up_mib(std::uint64_t bytes) {
  return (bytes + kMib - 1) / kMib;
}

std::uint64_t read_number(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t number = 0;
  return file >> number ? number : 0;
}

void warn_socket_buffer(const char* key, std::uint64_t limit, std::uint64_t wanted,
                        std::vector<std::string>& warnings) {
  if (limit == 0 || limit >= wanted) return;
  warnings.push_back("net.core." + std::string(key) + " is " + std::to_string(limit) + " bytes, wanted " +
                     std::to_string(wanted) + ": images over UDP may be lost; sudo sysctl -w net.core." + key + "=" +
                     std::to_string(wanted));
}

/// Everyone may open files of mode 666.
std::map<std::uint32_t, std::uint32_t> ports_of_others(const std::string& shm_dir) {
  constexpr mode_t kReadAndWrite = S_IROTH | S_IWOTH;
  std::map<std::uint32_t, std::uint32_t> found;
  std::error_code none;
  for (const auto& file : std::filesystem::directory_iterator(shm_dir, none)) {
    const std::string name = file.path().filename();
    const std::size_t port = name.find(kShmPort);
    struct stat status {};
    if (!is_shm_transport(name) || port == std::string::npos || stat(file.path().c_str(), &status) != 0) continue;
    if (status.st_uid == geteuid() || (status.st_mode & kReadAndWrite) == kReadAndWrite) continue;
    if (const auto number = io::parse_number(name.substr(port + kShmPort.size()));
        number && *number > 0 && *number < 65536)
      found[static_cast<std::uint32_t>(*number)] = status.st_uid;
  }
  return found;
}

}  // namespace

HostLimits read_host_limits(const std::string& shm_dir, const std::string& sysctl_dir) {
  HostLimits limits;
  struct statvfs shm {};
  if (statvfs(shm_dir.c_str(), &shm) == 0) {
    limits.shm_total = std::uint64_t{shm.f_blocks} * shm.f_frsize;
    limits.shm_free = std::uint64_t{shm.f_bavail} * shm.f_frsize;
  }
  limits.closed_ports = ports_of_others(shm_dir);
  limits.rmem_max = read_number(sysctl_dir + "/rmem_max");
  limits.wmem_max = read_number(sysctl_dir + "/wmem_max");
  return limits;
}

void require_shared_memory(const BusOptions& options, const HostLimits& limits) {
  if (limits.shm_total == 0 || !options.shared_memory) return;
  const std::uint64_t needed = options.shm_segment_mib * kMib + frame_pool_bytes();
  if (limits.shm_free >= needed) return;
  const std::uint64_t sufficient_mib =
      round_up_mib(kProcesses * options.shm_segment_mib * kMib + 2 * frame_pool_bytes());
  const std::string size = std::to_string(std::max<std::uint64_t>(sufficient_mib, 256)) + "m";
  throw BusError("/dev/shm is too small: " + std::to_string(limits.shm_free / kMib) + " MiB free of " +
                 std::to_string(limits.shm_total / kMib) + " MiB, this process needs " +
                 std::to_string(round_up_mib(needed)) + " MiB; sudo mount -o remount,size=" + size +
                 " /dev/shm, or start the container with --shm-size=" + size);
}

std::string why_not_shared_memory(const BusOptions& options, const HostLimits& limits) {
  const std::uint32_t first = discovery_port(options.domain);
  const auto port = limits.closed_ports.lower_bound(first);
  if (options.vendor != "fastdds" || port == limits.closed_ports.end() || port->first >= first + kPortsOfDomain)
    return {};
  return "a program of user " + std::to_string(port->second) + " is in DDS domain " + std::to_string(options.domain) +
         " (port " + std::to_string(port->first) + " in /dev/shm), which user " + std::to_string(geteuid()) +
         " may not open: what this user starts from now on uses UDP in its place; one user for both spares that";
}

std::vector<std::string> host_warnings(const BusOptions& options, const HostLimits& limits) {
  std::vector<std::string> warnings;
  if (options.vendor == kInprocess) return warnings;
  const std::uint64_t wanted_shm = kProcesses * options.shm_segment_mib * kMib + frame_pool_bytes();
  if (options.vendor == "fastdds" && limits.shm_total != 0 && limits.shm_total < wanted_shm) {
    warnings.push_back("/dev/shm holds " + std::to_string(limits.shm_total / kMib) +
                       " MiB, all processes together may need " + std::to_string(round_up_mib(wanted_shm)) +
                       " MiB; sudo mount -o remount,size=256m /dev/shm, or " +
                       "start the container with --shm-size=256m");
  }
  if (const std::string why = why_not_shared_memory(options, limits); !why.empty()) warnings.push_back(why);
  const std::uint64_t wanted_buffer = options.socket_buffer_kib * kKib;
  warn_socket_buffer("rmem_max", limits.rmem_max, wanted_buffer, warnings);
  warn_socket_buffer("wmem_max", limits.wmem_max, wanted_buffer, warnings);
  return warnings;
}

std::uint32_t socket_buffer_bytes(std::uint32_t requested_kib, std::uint64_t limit) {
  const std::uint64_t requested = std::min<std::uint64_t>(requested_kib * kKib, UINT32_MAX);
  return static_cast<std::uint32_t>(limit == 0 ? requested : std::min(requested, limit));
}

}  // namespace rtd::bus
