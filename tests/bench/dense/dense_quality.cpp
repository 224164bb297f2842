// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>

#include "tests/support/dense/dense_run.hpp"
#include "tests/support/dense/grid_truth.hpp"

namespace {

/// The floor plan against the scene.
void report_grid(const rtd::test_support::DenseOptions& options, const rtd::test_support::DenseReport& report,
                 const std::string& pgm_file) {
  if (!report.grid) {
    std::printf("grid: no floor\n");
    return;
  }
  const rtd::occupancy::NavigationGrid& grid = *report.grid;
  std::printf("grid %d x %d  floor %.3f m  %zu scans  %.1f ms CPU a frame  %.1f ms a plan\n", grid.columns, grid.rows,
              grid.floor_m, report.scans, report.grid_integrate_ms, report.grid_ms);
  if (!pgm_file.empty()) {
    std::ofstream file(pgm_file, std::ios::binary);
    rtd::occupancy::write_pgm(file, grid);
  }
  if (!options.source.starts_with("synthetic:")) return;
  const rtd::test_support::GridTruth truth(options.source, grid.cell_m, options.navigation.heights);
  const rtd::test_support::GridReport judged = truth.judge(grid);
  std::printf(
      "grid right %.4f (strictly %.4f)  free %zu, wrong %zu (%zu)  occupied %zu, wrong %zu (%zu)  ghosts %zu  "
      "found %.3f of %zu free cells\n",
      judged.share_right(), judged.share_right_strictly(), judged.free, judged.wrong_free, judged.mostly_wrong_free,
      judged.occupied, judged.wrong_occupied, judged.wholly_wrong_occupied, judged.ghosts, judged.share_found(),
      judged.truly_free);
}

}  // namespace

/// Builds the static map of a source and reports how many ghosts are in it: the instrument for tuning.
int main(int argc, char** argv) {
  CLI::App app("RTD-SLAM dense map: ghosts, completeness and times of one source");
  rtd::test_support::DenseOptions options;
  rtd::dense::DenseConfig& map = options.map;
  std::string ply_file, pgm_file;
  app.add_option("--source", options.source, "source URI")->required();
  app.add_option("--mode", options.front_end.mode, "off, true-mask or a mode of the filter")->capture_default_str();
  app.add_option("--detector", options.front_end.detector.kind, "real, truth, lying, off");
  app.add_option("--filter", options.front_end.filter_settings, "filter.KEY=VALUE");
  app.add_option("--every", options.every, "every so many-th frame");
  app.add_option("--voxel", map.fusion.voxel_m, "m");
  app.add_option("--judge-every", options.judge_every, "every so many-th frame judges the cloud; 0: none");
  app.add_option("--max-depth", map.fusion.max_depth_m, "m");
  app.add_option("--grow", map.fusion.mask_grow_cells, "cells");
  app.add_option("--carve-frames", map.carving.frames, "a large number switches carving off");
  app.add_option("--carve-margin", map.carving.margin_m, "m");
  app.add_option("--carve-sigmas", map.carving.sigmas);
  app.add_option("--min-sightings", map.carving.min_sightings);
  app.add_option("--gate", map.fusion.gate_sigmas);
  app.add_flag("!--without-masks", options.use_masks, "only slam, not the map, learns what moves");
  app.add_flag("!--without-loops", options.close_loops, "slam closes no loops");
  app.add_option("--ply", ply_file, "write the cloud here");
  app.add_flag("--grid", options.grid, "also make the floor plan and compare it with the scene");
  app.add_option("--pgm", pgm_file, "write the plan here");
  app.add_option("--cell", options.navigation.space.cell_m, "m, of the plan");
  app.add_option("--grid-points", options.navigation.min_points, "voxels of an occupied cell");
  app.add_option("--grid-frames", options.navigation.min_frames_in_free, "that must see what occupies free space");
  app.add_option("--grid-share", options.navigation.min_weight_share, "of a neighbour's weight, less is noise");
  app.add_option("--grid-sightings", options.navigation.min_sightings, "scans that saw through a free cell");
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
  if (options.grid) report_grid(options, report, pgm_file);
  if (!ply_file.empty()) {
    std::ofstream file(ply_file, std::ios::binary);
    rtd::dense::write_ply(file, report.cloud);
  }
  return 0;
}
