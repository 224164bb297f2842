// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/service/bus_config.hpp"
#include "services/evaluation/record/run_record.hpp"

namespace rtd::launcher {

using eval::kFilterModes;
/// Modes that look at no boxes need no detector.
inline bool needs_detector(const std::string& filter_mode) {
  return filter_mode != "off" && filter_mode != "geometry";
}

/// The command line of `rtd run`.
struct RunOptions {
  std::string source;
  std::string pace = "realtime";
  std::string filter_mode;  ///< one of kFilterModes; empty: configuration, default rtd
  service::BusArguments bus;
  std::vector<std::string> dds_of;  ///< "SERVICE=VENDOR": another DDS for one service
  std::string config_file;
  std::vector<std::string> overrides;  ///< "key=value" for any service
  std::string detector = "auto";  ///< "auto": when weights are found and the filter mode needs them; "off"; "remote"
  std::string model;              ///< ONNX file; empty: search
  std::string out_dir;
  std::string map;                         ///< map file to go on with; empty: a new map
  std::string save_map;                    ///< map file to write; empty: map.rtdmap in out_dir
  bool localize_only = false;              ///< leave the map as it is
  bool dense = false;                      ///< also fuse a dense static map
  std::string record;                      ///< also record all topics: FILE.mcap or a folder; empty = no
  std::vector<std::string> replay_topics;  ///< "detections", "features": of a recording, in place of who makes them
  bool quiet = false;
  std::uint64_t frames = 0;  ///< end after so many frames; 0 = all
};

}  // namespace rtd::launcher
