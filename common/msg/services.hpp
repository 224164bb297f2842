// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

namespace rtd::msg {

/// A process with a heartbeat. Its name is that of the heartbeat, of its section of the configuration, of its role in a
/// keystore and of the command `rtd NAME`.
struct NamedService {
  const char* name;
  const char* executable;
  const char* help;               ///< one line
  bool started_by_run = true;     ///< `rtd run` starts it, always or by an option
  bool in_package_of_all = true;  ///< false: installed by its own package
  bool in_every_run = false;      ///< `rtd run` without options starts it
};

/// The services, in the order in which a frame passes them.
inline constexpr std::array<NamedService, 10> kServices{{
    {.name = "camera", .executable = "rtd-camera", .help = "Publish the frames of a source", .in_every_run = true},
    {.name = "detector",
     .executable = "rtd-detector",
     .help = "Detect people and objects in images",
     .in_every_run = true},
    {.name = "filter",
     .executable = "rtd-filter",
     .help = "Extract features and find those on moving objects",
     .in_every_run = true},
    {.name = "slam", .executable = "rtd-slam", .help = "Track the camera and build the map", .in_every_run = true},
    {"dense", "rtd-dense", "Fuse a dense static map"},
    {"record", "rtd-record", "Record topics to MCAP files; recover and join recordings"},
    {"replay", "rtd-replay", "Replay a recording"},
    {.name = "viewer",
     .executable = "rtd-viewer",
     .help = "Show a run in the browser and in Foxglove: map, images, services",
     .in_package_of_all = false},
    {.name = "link",
     .executable = "rtd-link",
     .help = "Pass a robot's poses, images and detections to and from a fleet's domain",
     .started_by_run = false},
    {.name = "atlas",
     .executable = "rtd-atlas",
     .help = "Join the maps of several robots in one building",
     .started_by_run = false},
}};

inline std::vector<std::string> service_names() {
  std::vector<std::string> names;
  for (const NamedService& service : kServices) names.emplace_back(service.name);
  return names;
}

}  // namespace rtd::msg
