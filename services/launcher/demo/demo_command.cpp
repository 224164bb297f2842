// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/demo/demo_command.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <vector>

#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "services/evaluation/core/report/report.hpp"
#include "services/launcher/demo/tum_dataset.hpp"
#include "services/launcher/run/run_command.hpp"

namespace rtd::launcher {
namespace fs = std::filesystem;
namespace {

constexpr char kSyntheticSource[] = "synthetic:office?frames=300";

std::string choose_source(const DemoOptions& options) {
  if (!options.dataset.empty()) return "tum:" + fetch_tum_dataset(options.dataset);
  const char* data = std::getenv("RTD_DATA_DIR");
  std::error_code error;
  if (data != nullptr && fs::is_directory(fs::path(data) / "walk_xyz", error)) {
    return "tum:" + (fs::path(data) / "walk_xyz").string();
  }
  return kSyntheticSource;
}

/// Lockstep: the figures do not depend on how busy this host is, and a second demo gives the same ones.
RunResult run_mode(const DemoOptions& options, const std::string& source, const std::string& mode) {
  RunOptions run_options;
  run_options.source = source;
  run_options.pace = "lockstep";
  run_options.filter_mode = mode;
  run_options.bus = options.bus;
  run_options.frames = options.frames;
  run_options.out_dir = (fs::path(options.out_dir) / mode).string();
  return run(run_options);
}

std::string ate_text(const RunResult& result) {
  if (!result.summary || !result.summary->final_trajectory) return "-";
  return fmt::format("{:.4f} m", result.summary->final_trajectory->ate.error_m.rmse);
}

std::string coverage_text(const RunResult& result) {
  return result.summary && result.record.frames_in > 0 ? fmt::format("{:.1f} %", 100 * result.summary->coverage) : "-";
}

void tell_comparison(const RunResult& off, const RunResult& with, const std::string& page) {
  std::cout << fmt::format("\n  {:<28}{:>14}{:>12}\n", "", "ATE rmse", "coverage")
            << fmt::format("  {:<28}{:>14}{:>12}\n", "every point (--filter off)", ate_text(off), coverage_text(off))
            << fmt::format("  {:<28}{:>14}{:>12}\n", "static points (--filter rtd)", ate_text(with),
                           coverage_text(with))
            << "\n  both trajectories: " << page << "\n\n  next:\n"
            << "    rtd run --source tum:FOLDER --out DIR                     your own TUM RGB-D sequence, at its "
               "recorded pace\n"
            << "    rtd run --source bag:FILE --out DIR                       a ROS 1 bag\n"
            << "    rtd run --source 'synthetic:office?frames=0' --out DIR    no data at all, endless: Ctrl-C\n"
            << "    rtd demo --dataset fr3_walking_xyz                        a real sequence with people (download)\n"
            << "    rtd eval DIR/trajectory.txt GROUNDTRUTH                   judge any trajectory\n";
}

int run_both(const DemoOptions& options, const std::string& source) {
  std::cerr << "rtd demo, 1 of 2: every point is believed (--filter off)\n";
  const RunResult off = run_mode(options, source, "off");
  if (!off.summary || off.code == service::kInterrupted) return off.code;
  std::cerr << "\nrtd demo, 2 of 2: dynamic points are removed (--filter rtd)\n";
  const RunResult with = run_mode(options, source, "rtd");
  if (!with.summary || with.code == service::kInterrupted) return with.code;

  const fs::path page = fs::path(options.out_dir) / "demo.html";
  write_comparison_html({{"every point (off)", off.record}, {"static points (rtd)", with.record}}, page);
  tell_comparison(off, with, page.string());
  return with.code;
}

}  // namespace

int demo(const DemoOptions& options) {
  try {
    return run_both(options, choose_source(options));
  } catch (const service::ConfigError& error) {
    std::cerr << "rtd demo: " << error.what() << '\n';
    return service::kUsageOrConfig;
  } catch (const std::exception& error) {
    std::cerr << "rtd demo: " << error.what() << '\n';
    return service::kRunFailed;
  }
}

}  // namespace rtd::launcher
