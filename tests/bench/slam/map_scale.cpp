// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/map_scale.hpp"

#include <malloc.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <string>

namespace {

std::atomic<std::int64_t> allocations{0};

}  // namespace

extern "C" {
// glibc's own: the count needs no library and no environment.
void* __libc_malloc(std::size_t size);  // NOLINT(bugprone-reserved-identifier,readability-identifier-naming)

void* malloc(std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}
}

namespace {

using rtd::test_support::MapScaleReport;

/// CPU time of this thread.
std::int64_t cpu_ns() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

/// A line of /proc/self/status in MB.
double memory_mb(const std::string& key) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(key)) return std::stod(line.substr(key.size() + 1)) / 1024;
  }
  return 0;
}

double median_ms(const std::vector<std::int64_t>& costs_ns) {
  return static_cast<double>(rtd::test_support::median(costs_ns)) * 1e-6;
}

void print_row(const char* name, const rtd::test_support::MapScaleCosts& costs) {
  std::printf("%-10s %10.2f %10.2f %10.2f %12ld\n", name, median_ms(costs.tracking), median_ms(costs.insertion),
              median_ms(costs.snapshot), static_cast<long>(rtd::test_support::median(costs.allocations)));
}

void print(const MapScaleReport& report) {
  std::printf("map: %zu keyframes of %zu inserted, %zu features, %zu landmarks, %zu observations\n", report.keyframes,
              report.insertions, report.features, report.landmarks, report.observations);
  std::printf("frames %zu, not tracked %zu, worst motion error %.4f m, invariants: %s\n", report.frames,
              report.lost_frames, report.max_error_m,
              report.broken_invariant.empty() ? "hold" : report.broken_invariant.c_str());
  std::printf(
      "map          tracking  insertion   snapshot  allocations   (medians, ms of CPU time and of a frame, both maps "
      "in turn)\n");
  print_row("100", report.small);
  print_row("this one", report.large);
  std::printf("tracking, this one / 100 keyframes: %.2f\n",
              median_ms(report.large.tracking) / median_ms(report.small.tracking));
  std::printf("whole map: trajectory %.1f ms, points %.1f ms\n", static_cast<double>(report.trajectory_ns) * 1e-6,
              static_cast<double>(report.map_points_ns) * 1e-6);
}

}  // namespace

/// Grows a map to thousands of keyframes with the real tracker and mapper: what a frame and a keyframe cost then.
int main(int argc, char** argv) {
  CLI::App app("RTD-SLAM map scale: cost per frame and per keyframe, and memory, as the map grows");
  rtd::test_support::MapScaleOptions options;
  options.now_ns = cpu_ns;
  options.allocations = [] { return allocations.load(std::memory_order_relaxed); };
  std::string path = "aisles";
  app.add_option("--keyframes", options.keyframes, "in the map at the end; room: insertions")
      ->check(CLI::Range(100, 1000000));
  app.add_option("--path", path, "aisles: always new places; room: always the same")
      ->check(CLI::IsMember({"aisles", "room"}));
  app.add_option("--points", options.world.points_per_m3, "density of the world, sets the features per frame");
  app.add_option("--seed", options.world.seed);
  app.add_option("--full-mapping", options.full_mapping,
                 "fusion and adjustment only in the first and last so many insertions: sooner there");
  CLI11_PARSE(app, argc, argv);
  options.path = path == "room" ? rtd::test_support::WalkPath::kRoom : rtd::test_support::WalkPath::kAisles;
  options.on_keyframe = [](std::size_t insertions) {
    if (insertions % 1000 != 0) return;
    std::printf("%zu keyframes: %.0f MB resident, %.0f MB allocated, %.0f s\n", insertions, memory_mb("VmRSS:"),
                static_cast<double>(mallinfo2().uordblks) / 1048576, static_cast<double>(cpu_ns()) * 1e-9);
    std::fflush(stdout);
  };
  const MapScaleReport report = rtd::test_support::run_map_scale(options);
  print(report);
  std::printf("peak memory %.0f MB\n", memory_mb("VmHWM:"));
  return 0;
}
