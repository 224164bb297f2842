// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/dense/dense_run.hpp"

/// Builds the static map of a source and reports how many ghosts are in it: the instrument for tuning.
int main(int argc, char** argv) {
  CLI::App app("RTD-SLAM dense map: ghosts, completeness and times of one source");
  rtd::test_support::DenseOptions options;
  rtd::dense::DenseConfig& map = options.map;
  std::string ply_file, background_file;
  app.add_option("--source", options.source, "source URI")->required();
  app.add_option("--mode", options.front_end.mode, "off, true-mask or a mode of the filter")->capture_default_str();
  app.add_option("--detector", options.front_end.detector.kind, "real, truth, lying, off");
  app.add_option("--filter", options.front_end.filter_settings, "filter.KEY=VALUE");
  app.add_option("--every", options.every, "every so many-th frame");
  app.add_option("--voxel", map.fusion.voxel_m, "m");
  app.add_option("--max-depth", map.fusion.max_depth_m, "m");
  app.add_option("--grow", map.fusion.mask_grow_cells, "cells");
  app.add_option("--carve-frames", map.carving.frames, "a large number switches carving off");
  app.add_option("--carve-margin", map.carving.margin_m, "m");
  app.add_option("--carve-sigmas", map.carving.sigmas);
  app.add_option("--min-sightings", map.carving.min_sightings);
  app.add_option("--gate", map.fusion.gate_sigmas);
  app.add_option("--background", background_file, "write the last frame without what moves here");
  app.add_flag("!--without-masks", options.use_masks, "the map is not told what moves, only slam is");
  app.add_option("--ply", ply_file, "write the cloud here");
  CLI11_PARSE(app, argc, argv);
  const rtd::test_support::DenseReport report = rtd::test_support::run_dense(options);
  const rtd::test_support::GhostReport& ghosts = report.ghosts;
  std::printf(
      "frames %zu  integrated %zu  points %zu of %zu voxels  fused %llu  masked %llu  carved %llu  %.1f ms CPU each\n",
      report.frames, report.integrated, report.cloud.size(), report.voxels,
      static_cast<unsigned long long>(report.fused), static_cast<unsigned long long>(report.masked),
      static_cast<unsigned long long>(report.carved), report.integrate_ms);
  std::printf("ghosts %zu (%.2f %%): floating %zu, on movers %zu, of %zu judged  error median %.4f m  complete %.3f\n",
              ghosts.ghosts(), 100 * ghosts.ghost_share(), ghosts.floating, ghosts.on_movers, ghosts.judged,
              ghosts.error_median_m, ghosts.completeness);
  if (!ply_file.empty()) {
    std::ofstream file(ply_file, std::ios::binary);
    rtd::dense::write_ply(file, report.cloud);
  }
  if (!background_file.empty()) cv::imwrite(background_file, report.background);
  return 0;
}
