// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/geometry/camera_model.hpp"

namespace rtd::dense {

/// How points become voxels.
struct FusionConfig {
  double voxel_m = 0.02;
  int max_voxels = 1'500'000;
  int stride_px = 2;
  double min_depth_m = 0.3;
  double max_depth_m = 6.0;
  double gate_sigmas = 3.0;
  double max_weight = 100.0;  ///< in points seen at 1 m
  double edge_m = 0.04;
  double edge_per_m = 0.01;
  int mask_grow_cells = 2;
  bool unknown_is_static = false;

  void bind(auto& binder) {
    binder.field("voxel_m", voxel_m, {0.002, 1.0}, "side length of a voxel");
    binder.field("max_voxels", max_voxels, {1000, 50'000'000}, "about 90 bytes each; at this number no new ones");
    binder.field("stride_px", stride_px, {1, 16}, "one column and row in so many is fused");
    binder.field("min_depth_m", min_depth_m, {0.0, 10.0}, "nearer readings count as not measured");
    binder.field("max_depth_m", max_depth_m, {0.5, 50.0}, "farther readings are too noisy to draw a surface");
    binder.field("gate_sigmas", gate_sigmas, {0.0, 10.0},
                 "a point joins the surface along its ray within so many standard deviations");
    binder.field("max_weight", max_weight, {1.0, 1e6}, "of a voxel: limits how long the past counts");
    binder.field("edge_m", edge_m, {0.001, 1.0}, "depth step to a neighbouring pixel that makes a mixed reading");
    binder.field("edge_per_m", edge_per_m, {0.0, 1.0}, "plus this times depth squared");
    binder.field("mask_grow_cells", mask_grow_cells, {0, 20}, "the filter's mask grows by so many cells");
    binder.field("unknown_is_static", unknown_is_static, "also fuse what the filter could not judge");
  }
};

/// When a voxel is believed, and when it vanishes.
struct CarvingConfig {
  double margin_m = 0.06;
  double sigmas = 4.0;
  int frames = 3;
  int max_evidence = 5;
  int min_sightings = 2;

  void bind(auto& binder) {
    binder.field("margin_m", margin_m, {0.005, 2.0}, "a voxel is seen through if the reading lies so far behind it");
    binder.field("sigmas", sigmas, {0.0, 20.0}, "and so many standard deviations of depth");
    binder.field("frames", frames, {1, 10000}, "a voxel seen through so many times more often than seen is removed");
    binder.field("max_evidence", max_evidence, {1, 10000}, "more sightings do not count: old surfaces can leave, too");
    binder.field("min_sightings", min_sightings, {1, 1000}, "voxels seen in fewer frames are not published");
  }
};

struct DenseConfig {
  FusionConfig fusion;
  CarvingConfig carving;
  geometry::DepthNoise noise;

  void bind(auto& binder) {
    binder.section("fusion", fusion);
    binder.section("carving", carving);
  }
};

}  // namespace rtd::dense
