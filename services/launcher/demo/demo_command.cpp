// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/demo/demo_command.hpp"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <vector>

#include "common/io/atomic_file.hpp"
#include "common/process/executable.hpp"
#include "common/process/out_folder.hpp"
#include "common/service/command_line.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/standard_streams.hpp"
#include "services/launcher/doctor/doctor_command.hpp"
#include "services/launcher/run/run_command.hpp"

namespace rtd::launcher {
namespace fs = std::filesystem;
namespace {

constexpr char kSyntheticSource[] = "synthetic:office?frames=300&figures=drawn";
/// With people.
constexpr char kPublicSequence[] = "rgbd_dataset_freiburg3_walking_xyz";
constexpr char kPublicUrl[] = "https://cvg.cit.tum.de/rgbd/dataset/freiburg3/";

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string choose_source(const DemoOptions& options) {
  if (!options.source.empty()) return options.source;
  const std::string data = demo_data_folder();
  return data.empty() ? kSyntheticSource : "tum:" + (fs::path(data) / kDemoSequence).string();
}

/// Lockstep: the figures do not depend on the load of this host, and a second demo gives the same ones.
RunResult run_mode(const DemoOptions& options, const std::string& source, const std::string& mode) {
  RunOptions run_options;
  run_options.source = source;
  run_options.pace = "lockstep";
  run_options.config = options.config;
  run_options.config.given.push_back({"filter.mode", "--filter", {mode}});
  run_options.frames = options.frames;
  run_options.show_masks = true;
  run_options.out_dir = (fs::path(options.out_dir) / mode).string();
  return run(run_options);
}

/// Shows both runs on one page and prints their errors. Returns the exit code of rtd-eval.
int compare(const std::string& out_dir, const std::string& page) {
  const fs::path folder = out_dir;
  return process::run_in_foreground(
      process::require_executable("rtd-eval"),
      {"compare", (folder / "off").string(), (folder / "rtd").string(), "--label", "every point (--filter off)",
       "--label", "static points (--filter rtd)", "--page", page});
}

/// "rtd" where the shell finds it, else with its folder.
std::string command_of_rtd() {
  std::istringstream folders(environment("PATH"));
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((fs::path(folder) / "rtd").c_str(), X_OK) == 0) return "rtd";
  const std::string executable = process::find_executable("rtd");
  return executable.empty() ? "rtd" : fs::proximate(executable).string();
}

/// Each can be copied as it is; the page is named last.
void print_next_steps(const std::string& out_dir, const std::string& page, const std::string& detector) {
  const std::string rtd = command_of_rtd(), run = (fs::path(out_dir) / "rtd").string();
  std::cout << "\n  detector weights: " << detector << "\n\n  next:\n"
            << "    " << rtd << " run --source 'synthetic:office?frames=0' --out /tmp/office    endless: Ctrl-C\n"
            << "    " << rtd << " eval " << run << "/trajectory.txt " << run << "/groundtruth.txt\n"
            << "    curl " << kPublicUrl << kPublicSequence << ".tgz | tar xz    a real sequence with people\n"
            << "    " << rtd << " demo --source tum:" << kPublicSequence << '\n'
            << "    " << rtd << " run --help    your own data: folders, bags, recordings, cameras\n"
            << "\n  both trajectories: " << fs::absolute(page).lexically_normal().string() << std::endl;
}

int run_both(const DemoOptions& options, const std::string& source) {
  process::require_executable("rtd-eval");  // a demo without its report has nothing to show
  const std::string page = (fs::path(options.out_dir) / "demo.html").string();  // the runs' pages link to it
  io::write_file(page, "<!doctype html><title>RTD-SLAM</title>Both runs are compared here once they have ended.\n");
  std::cerr << "rtd demo, 1 of 2: every point is used (--filter off)\n";
  const RunResult off = run_mode(options, source, "off");
  if (off.report != ReportState::kWritten || off.code == service::kInterrupted) return off.code;
  std::cerr << "\nrtd demo, 2 of 2: dynamic points are removed (--filter rtd)\n";
  const RunResult with = run_mode(options, source, "rtd");
  if (with.report != ReportState::kWritten || with.code == service::kInterrupted) return with.code;

  if (compare(options.out_dir, page) != 0) return service::kRunFailed;
  print_next_steps(options.out_dir, page, with.detector);
  return off.code == service::kOk ? with.code : off.code;
}

}  // namespace

int demo(const DemoOptions& options) {
  service::outlive_readers();
  return service::report_errors<service::ConfigError>("rtd demo", std::cerr, [&]() -> int {
    const process::FolderLock folder = process::take_out_folder(options.out_dir);
    return run_both(options, choose_source(options));
  });
}

}  // namespace rtd::launcher
