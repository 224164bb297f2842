// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/demo/demo_command.hpp"

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <vector>

#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "services/launcher/demo/tum_dataset.hpp"
#include "services/launcher/process/executable.hpp"
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

/// The report of a demo is its result: without rtd-eval there is nothing to show.
std::string require_rtd_eval() {
  std::string executable = find_executable("rtd-eval");
  if (executable.empty()) throw service::ConfigError(missing_executable("rtd-eval"));
  return executable;
}

/// Lockstep: the figures do not depend on the load of this host, and a second demo gives the same ones.
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

/// Shows both runs on one page and prints their errors. Returns the exit code of rtd-eval.
int compare(const std::string& out_dir, const std::string& page) {
  const fs::path folder = out_dir;
  return run_in_foreground(require_rtd_eval(),
                           {"compare", (folder / "off").string(), (folder / "rtd").string(), "--label",
                            "every point (--filter off)", "--label", "static points (--filter rtd)", "--page", page});
}

void print_next_steps(const std::string& page) {
  std::cout << "\n  both trajectories: " << page << "\n\n  next:\n"
            << "    rtd run --source tum:FOLDER --out DIR                     your own TUM RGB-D sequence, at its "
               "recorded pace\n"
            << "    rtd run --source bag:FILE --out DIR                       a ROS 1 bag\n"
            << "    rtd run --source 'synthetic:office?frames=0' --out DIR    no data at all, endless: Ctrl-C\n"
            << "    rtd demo --dataset fr3_walking_xyz                        a real sequence with people (download)\n"
            << "    rtd eval DIR/trajectory.txt GROUNDTRUTH                   evaluate any trajectory\n";
}

int run_both(const DemoOptions& options, const std::string& source) {
  require_rtd_eval();
  std::cerr << "rtd demo, 1 of 2: every point is used (--filter off)\n";
  const RunResult off = run_mode(options, source, "off");
  if (off.report != ReportState::kWritten || off.code == service::kInterrupted) return off.code;
  std::cerr << "\nrtd demo, 2 of 2: dynamic points are removed (--filter rtd)\n";
  const RunResult with = run_mode(options, source, "rtd");
  if (with.report != ReportState::kWritten || with.code == service::kInterrupted) return with.code;

  const std::string page = (fs::path(options.out_dir) / "demo.html").string();
  if (compare(options.out_dir, page) != 0) return service::kRunFailed;
  print_next_steps(page);
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
