// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace rtd::eval {

/// The command line of `rtd benchmark`.
struct BenchmarkOptions {
  std::string dataset;               ///< tum, bonn, openloris
  std::vector<std::string> folders;  ///< searched for sequences
  int runs = 5;                      ///< of each mode on each sequence, perturbed
  std::vector<std::string> modes;    ///< empty: all
  std::string out_dir;               ///< empty: rtd_benchmark_<dataset>
  std::string compare;               ///< benchmark.json of another benchmark; empty: none
  int jobs = 1;                      ///< runs beside each other
  std::uint64_t frames = 0;          ///< of each run; 0 = all
  std::vector<std::string> set;      ///< "filter.KEY=VALUE", "slam.KEY=VALUE"
  std::string detector = "auto";     ///< or "off"
  std::string program;               ///< empty: the rtd_offline_run of this build
  bool json = false;                 ///< JSON on standard output instead of the table
};

void add_benchmark_command(CLI::App& app, BenchmarkOptions& options);

/// `rtd benchmark`: every mode on every sequence of a public dataset, several perturbed runs each, beside published
/// figures. Writes benchmark.json and benchmark.html after every run and continues where an earlier call of the same
/// build and options stopped. Returns the exit code: 0; 1 when a run failed; 2 when nothing could be started; 3 when
/// sequences were left out; 130 when interrupted.
int run_benchmark(const BenchmarkOptions& options);

}  // namespace rtd::eval
