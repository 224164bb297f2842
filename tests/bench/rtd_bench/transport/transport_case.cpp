// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/rtd_bench/transport/transport_case.hpp"

namespace rtd::bench {
namespace {

struct PathName {
  Path path;
  const char* name;
  const char* vendor;
  bool fixed_size_only;
};
constexpr PathName kPaths[] = {{Path::kSharing, "sharing", "fastdds", true},
                               {Path::kSharedMemory, "shm", "fastdds", false},
                               {Path::kUdp, "udp", "", false}};

struct PayloadName {
  Payload payload;
  const char *name, *title;
  bool fixed_size;
};
constexpr PayloadName kPayloads[] = {{Payload::kFrame, "frame", "raw frame, 1.5 MB", true},
                                     {Payload::kFrame848, "frame-848x480", "raw frame, 2.0 MB", true},
                                     {Payload::kFrame1280, "frame-1280x720", "raw frame, 4.6 MB", true},
                                     {Payload::kFrame1920, "frame-1920x1200", "raw frame, 11.5 MB", true},
                                     {Payload::kJpeg, "jpeg", "JPEG, 300 kB", false},
                                     {Payload::kFeatures, "features", "features, 262 kB", true},
                                     {Payload::kPose, "pose", "pose, 0.1 kB", false}};

const PayloadName& entry(Payload payload) {
  return kPayloads[static_cast<std::size_t>(payload)];
}

}  // namespace

const char* to_string(Path path) {
  return kPaths[static_cast<std::size_t>(path)].name;
}

const char* to_string(Payload payload) {
  return entry(payload).name;
}

const char* title(Payload payload) {
  return entry(payload).title;
}

std::optional<Payload> parse_payload(const std::string& text) {
  for (const PayloadName& known : kPayloads) {
    if (text == known.name) return known.payload;
  }
  return std::nullopt;
}

std::optional<Path> parse_path(const std::string& text) {
  for (const PathName& known : kPaths) {
    if (text == known.name) return known.path;
  }
  return std::nullopt;
}

std::vector<TransportCase> transport_cases(const TransportOptions& options) {
  std::vector<std::string> vendors = options.vendors.empty() ? bus::dds_vendors() : options.vendors;
  std::vector<TransportCase> cases;
  for (const Payload payload : options.payloads) {
    for (const std::string& vendor : vendors) {
      for (const PathName& path : kPaths) {
        const bool offered = path.vendor[0] == '\0' || vendor == path.vendor;
        if (offered && (entry(payload).fixed_size || !path.fixed_size_only)) {
          cases.push_back({vendor, path.path, payload});
        }
      }
    }
  }
  return cases;
}

bus::BusOptions bus_options(const TransportCase& what, std::uint32_t domain, const std::string& name) {
  bus::BusOptions options;
  options.vendor = what.vendor;
  options.domain = domain;
  options.participant_name = name;
  options.shared_memory = what.path != Path::kUdp;
  return options;
}

}  // namespace rtd::bench
