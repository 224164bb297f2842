// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/service/config.hpp"
#include "services/dense/core/dense_config.hpp"

namespace rtd::dense {

/// Section `dense` of the configuration. The numbers of the core have their defaults in core/dense_config.hpp.
struct ServiceConfig {
  DenseConfig core;
  std::string out_dir;         ///< static_map.ply is written here at the end; empty = nowhere
  int every = 5;               ///< every so many-th frame is fused, and each keyframe
  bool without_masks = false;  ///< fuse frames of which the filter says nothing as if all were static
  bool background = false;     ///< also write background.png: the last frame without what moves in it
  int background_views = 24;   ///< earlier frames kept for it, 1.6 MB each
  std::string map_frame = "map";
  int publish_period_ms = 1000;     ///< between two clouds on rt/dense/points
  int publish_max_points = 200000;  ///< 16 bytes each; more: larger cells

  void bind(service::ConfigBinder& binder);
};

}  // namespace rtd::dense
