// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/optimize/bundle_adjustment.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <vector>

#include "common/service/monotonic_clock.hpp"
#include "services/slam/core/config/slam_config.hpp"
#include "tests/support/bundle_scene.hpp"

namespace {

using rtd::service::monotonic_ns;
using rtd::slam::BundleSolver;
using rtd::test_support::BundleScene;

double to_ms(std::int64_t duration_ns) {
  return static_cast<double>(duration_ns) * 1e-6;
}

double percentile(std::vector<double> values, double fraction) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1))];
}

rtd::slam::BundleOptions product_options(rtd::slam::BundleSolver solver) {
  const rtd::slam::MapperConfig config;
  rtd::slam::BundleOptions options{config.ba_iterations_robust, config.ba_iterations};
  options.solver = solver;
  return options;
}

/// Returns the median, ms.
double measure_whole(const BundleScene& scene, BundleSolver solver, int runs) {
  std::vector<double> times_ms;
  rtd::slam::BundleSummary summary;
  BundleScene adjusted = scene;
  for (int run = 0; run < runs; ++run) {
    adjusted.problem = scene.problem;
    const std::int64_t start_ns = monotonic_ns();
    summary = rtd::slam::adjust_bundle(adjusted.problem, product_options(solver));
    times_ms.push_back(to_ms(monotonic_ns() - start_ns));
  }
  std::printf("  whole: median %.1f  p90 %.1f ms  (%d evaluations, cost %.0f -> %.0f, %d outliers, camera %.2f mm)\n",
              percentile(times_ms, 0.5), percentile(times_ms, 0.9), summary.iterations, summary.initial_cost,
              summary.final_cost, summary.outliers, 1e3 * rtd::test_support::worst_camera_error_m(adjusted));
  return percentile(times_ms, 0.5);
}

/// Raises the flag at moments all over the adjustment: how long until it has returned?
void measure_interrupt(const BundleScene& scene, BundleSolver solver, double whole_ms, int runs) {
  std::vector<double> delays_ms;
  for (int run = 0; run < runs; ++run) {
    BundleScene adjusted = scene;
    rtd::slam::BundleOptions options = product_options(solver);
    const std::int64_t start_ns = monotonic_ns();
    const std::int64_t raised_ns = start_ns + static_cast<std::int64_t>(1e6 * whole_ms * run / runs);
    options.interrupted = [raised_ns] { return monotonic_ns() >= raised_ns; };
    rtd::slam::adjust_bundle(adjusted.problem, options);
    delays_ms.push_back(std::max(0.0, to_ms(monotonic_ns() - raised_ns)));
  }
  std::printf("  interrupt to return: median %.1f  p90 %.1f  worst %.1f ms\n", percentile(delays_ms, 0.5),
              percentile(delays_ms, 0.9), percentile(delays_ms, 1.0));
}

}  // namespace

/// What one local bundle adjustment costs, and how soon it ends when a keyframe waits for the mapper.
int main(int argc, char** argv) {
  CLI::App app("RTD-SLAM bundle adjustment: cost, and time from interrupt to return");
  rtd::test_support::BundleSceneOptions options;
  int runs = 25;
  app.add_option("--keyframes", options.keyframes, "adjusted");
  app.add_option("--fixed", options.fixed_keyframes, "more keyframes that hold the gauge");
  app.add_option("--landmarks", options.landmarks);
  app.add_option("--runs", runs)->check(CLI::Range(3, 10000));
  CLI11_PARSE(app, argc, argv);
  const BundleScene scene = rtd::test_support::make_bundle_scene(options);
  std::printf("%zu + %zu fixed keyframes, %zu landmarks, %zu observations\n", options.keyframes,
              options.fixed_keyframes, scene.problem.points.size(), scene.problem.observations.size());
  for (const BundleSolver solver : {BundleSolver::kDense, BundleSolver::kSparse}) {
    std::printf("%s\n", solver == BundleSolver::kDense ? "dense (local bundle adjustment):" : "Ceres:");
    const double whole_ms = measure_whole(scene, solver, runs);
    measure_interrupt(scene, solver, whole_ms, runs);
  }
  return 0;
}
