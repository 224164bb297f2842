// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/geometry/depth_noise.hpp"

namespace rtd::dense {

/// How points become voxels.
struct FusionConfig {
  double voxel_m = 0.02;           ///< side of a voxel
  int max_voxels = 1'500'000;      ///< about 90 bytes each; when reached, no new ones are made
  int stride_px = 2;               ///< every so many-th column and row is fused
  double min_depth_m = 0.3;        ///< nearer readings count as not measured
  double max_depth_m = 6.0;        ///< farther readings are too noisy to draw a surface
  double gate_sigmas = 3.0;        ///< a point joins the surface along its ray within so many standard deviations
  double max_weight = 100.0;       ///< of a voxel, in points seen at 1 m: bounds how long the past counts
  double edge_m = 0.04;            ///< a depth step to a neighbouring pixel that makes a reading a mixed one ...
  double edge_per_m = 0.01;        ///< ... plus this times depth squared
  int mask_grow_cells = 2;         ///< the filter's mask grows by so many cells
  bool unknown_is_static = false;  ///< fuse also what the filter could not judge
};

/// When a voxel is believed, and when it vanishes.
struct CarvingConfig {
  double margin_m = 0.06;  ///< a voxel is seen through when what is measured lies farther behind it than this ...
  double sigmas = 4.0;     ///< ... and so many standard deviations of the reading
  int frames = 3;          ///< seen through so many times more often than seen: gone
  int max_evidence = 5;    ///< more sightings count no more: what has stood for long can still leave
  int min_sightings = 2;   ///< voxels seen in fewer frames are not given out
};

struct DenseConfig {
  FusionConfig fusion;
  CarvingConfig carving;
  geometry::DepthNoise noise;
};

}  // namespace rtd::dense
