// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/service/config.hpp"
#include "services/slam/core/slam_config.hpp"

namespace rtd::slam {

/// Where the map comes from and goes to.
struct MapFileConfig {
  std::string load;          ///< map file to go on with; empty = a new map
  std::string save;          ///< map file to write at the end and at checkpoints; empty = none
  double checkpoint_s = 30;  ///< between two checkpoints; 0 = only at the end
};

/// Section `slam` of the configuration. The numbers of the core have their defaults in core/slam_config.hpp.
struct ServiceConfig {
  SlamConfig core;              ///< but for place.vocabulary: with_vocabulary()
  std::string vocabulary_file;  ///< empty: the built-in vocabulary
  MapFileConfig map;
  std::string out_dir;  ///< trajectory, keyframes and map are written here at the end; empty = nowhere
  std::string map_frame = "map";
  std::string odom_frame = "odom";
  std::string camera_frame = "camera_color_optical_frame";
  int path_length = 2000;    ///< poses kept for rt/slam/path
  int path_period_ms = 500;  ///< between two paths
  int map_period_ms = 1000;  ///< between two clouds on rt/slam/map_points

  void bind(service::ConfigBinder& binder);
  /// Throws service::ConfigError for keys that contradict each other.
  void validate() const;
};

/// The configuration of the core with the vocabulary of `vocabulary_file`. Throws service::ConfigError naming the file
/// when it cannot be read or is damaged.
SlamConfig with_vocabulary(const ServiceConfig& config);

}  // namespace rtd::slam
