// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/dense/core/dense_config.hpp"

namespace rtd::dense {

/// Section `dense` of the configuration.
struct ServiceConfig {
  std::string out_dir;
  int every = 5;
  bool without_masks = false;
  bool background = false;
  int background_views = 24;
  std::string map_frame = "map";
  int publish_period_ms = 1000;
  int publish_max_points = 200000;
  DenseConfig core;

  void bind(auto& binder) {
    binder.field("out", out_dir, "folder for static_map.ply, written at the end; empty: none");
    binder.field("every", every, {1, 10000}, "one frame in so many is fused, and each keyframe");
    binder.field("without_masks", without_masks,
                 "also fuse frames without a mask from the filter: moving objects leave ghosts");
    binder.field("background", background, "also write background.png: the last frame without moving objects");
    binder.field("background_views", background_views, {1, 500}, "earlier frames kept for it, 1.6 MB each");
    binder.field("map_frame", map_frame, "frame of the published cloud");
    binder.field("publish_period_ms", publish_period_ms, {100, 600'000}, "between two clouds on rt/dense/points");
    binder.field("publish_max_points", publish_max_points, {100, 500'000},
                 "of a published cloud, 16 bytes each; for more points the cells get larger");
    core.bind(binder);
  }
};

}  // namespace rtd::dense
