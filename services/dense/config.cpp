// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/dense/config.hpp"

namespace rtd::dense {
namespace {

using service::ConfigBinder;

void bind_fusion(ConfigBinder& binder, FusionConfig& c) {
  binder.field("fusion.voxel_m", c.voxel_m, {0.002, 1.0}, "side of a voxel");
  binder.field("fusion.max_voxels", c.max_voxels, {1000, 50'000'000}, "about 90 bytes each; then no new ones");
  binder.field("fusion.stride_px", c.stride_px, {1, 16}, "every so many-th column and row");
  binder.field("fusion.min_depth_m", c.min_depth_m, {0.0, 10.0}, "nearer readings count as not measured");
  binder.field("fusion.max_depth_m", c.max_depth_m, {0.5, 50.0}, "farther readings count as not measured");
  binder.field("fusion.gate_sigmas", c.gate_sigmas, {0.0, 10.0}, "a point so near along its ray joins a surface");
  binder.field("fusion.max_weight", c.max_weight, {1.0, 1e6}, "bounds how long the past counts");
  binder.field("fusion.edge_m", c.edge_m, {0.001, 1.0}, "a larger depth step makes a reading a mixed one");
  binder.field("fusion.edge_per_m", c.edge_per_m, {0.0, 1.0}, "plus this times depth squared");
  binder.field("fusion.mask_grow_cells", c.mask_grow_cells, {0, 20}, "the filter's mask grows by so many cells");
  binder.field("fusion.unknown_is_static", c.unknown_is_static, "fuse also what the filter could not judge");
}

void bind_carving(ConfigBinder& binder, CarvingConfig& c) {
  binder.field("carving.margin_m", c.margin_m, {0.005, 2.0}, "measured so far behind a voxel: seen through");
  binder.field("carving.sigmas", c.sigmas, {0.0, 20.0}, "and so many standard deviations of depth");
  binder.field("carving.frames", c.frames, {1, 10000}, "seen through so many times more often than seen: gone");
  binder.field("carving.max_evidence", c.max_evidence, {1, 10000}, "more sightings count no more");
  binder.field("carving.min_sightings", c.min_sightings, {1, 1000}, "voxels seen in fewer frames are not given out");
}

}  // namespace

void ServiceConfig::bind(ConfigBinder& binder) {
  binder.field("out", out_dir, "folder for static_map.ply; empty: none");
  binder.field("every", every, {1, 10000}, "every so many-th frame is fused, and each keyframe");
  binder.field("without_masks", without_masks, "fuse frames of which the filter says nothing: movers leave ghosts");
  binder.field("background", background, "also write background.png: the last frame without what moves");
  binder.field("background_views", background_views, {1, 500}, "earlier frames kept for it, 1.6 MB each");
  binder.field("map_frame", map_frame, "frame of the cloud in the message");
  binder.field("publish_period_ms", publish_period_ms, {100, 600'000}, "between two clouds");
  binder.field("publish_max_points", publish_max_points, {100, 500'000}, "of a published cloud; more: larger cells");
  bind_fusion(binder, core.fusion);
  bind_carving(binder, core.carving);
}

}  // namespace rtd::dense
