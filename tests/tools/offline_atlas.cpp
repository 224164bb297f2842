// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// rtd_offline_atlas: robots that walk through sources one after the other, and the joint map of them. What
/// docs/results.md says about the atlas comes from here.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <sstream>

#include "tests/support/atlas_trial.hpp"

namespace {

using namespace rtd::test_support;

void print(const ScaleResult& result, int robots, int seconds) {
  std::cout << fmt::format(
      "{} robots, {} s: {} keyframes sent, {} kept, CPU {:.0f} s, p99 {:.1f} ms, longest {:.0f} ms, peak {:.0f} MB{}\n",
      robots, seconds, result.keyframes, result.kept, result.cpu_s, result.p99_ms, result.longest_ms, result.peak_mb,
      result.all_met ? ", all met" : ", NOT ALL MET");
}

void print(const TrialResult& result) {
  double alone_m = 0, live_m = 0;  // means over the robots
  for (const TrialResult::Robot& robot : result.robots) {
    alone_m += robot.ate_alone_m / static_cast<double>(result.robots.size());
    live_m += robot.live_alone_m / static_cast<double>(result.robots.size());
    std::cout << fmt::format(
        "{}: {} meetings {} keyframes {} ate alone {:.4f} (live {:.4f}) m, joint {:.4f} m, {:.0f} kB/s, first pose "
        "after {:.2f} s, {:.4f} m wrong; {:.1f} ms a keyframe, {:.1f} ms a correction\n",
        robot.name, robot.met ? "met" : "NOT MET", robot.meetings, robot.keyframes, robot.ate_alone_m,
        robot.live_alone_m, robot.ate_joint_m, robot.kilobytes_per_s, robot.first_pose_s, robot.first_pose_error_m,
        robot.add_ms, robot.straighten_ms);
  }
  const rtd::atlas::AtlasCounters& counters = result.counters;
  std::cout << fmt::format(
      "joint ate {:.4f} m, {:.2f} of the mean alone; live {:.4f} m, {:.2f}; {} keyframes met, {} implausible, {} "
      "alike, {} meetings, {} refused, {} corrections, {} gave way\n",
      result.ate_joint_m, result.ate_joint_m / alone_m, result.live_joint_m, result.live_joint_m / live_m, counters.met,
      counters.implausible, counters.alike, counters.meetings, counters.refused, counters.corrections,
      counters.given_way);
}

}  // namespace

int main(int argc, char** argv) {
  OfflineOptions options;
  std::vector<std::string> walks;
  CLI::App app{"Robots that walk through sources one after the other, and the joint map of them", "rtd_offline_atlas"};
  app.add_option("--mode", options.front_end.mode, "off, true-mask, or a mode of the filter")->capture_default_str();
  app.add_option("--model", options.front_end.detector.model, "As of rtd run");
  rtd::atlas::AtlasConfig config;
  app.add_option("--sigma", config.meeting_sigma_m);
  app.add_option("--sigma-rad", config.meeting_sigma_rad);
  app.add_option("--bend", config.most_bend_m);
  app.add_option("--bend-share", config.most_bend_share);
  app.add_option("--cell", config.cell_keyframes);
  app.add_option("--look", config.look_every);
  bool together = false;
  app.add_flag("--together", together, "Robots walk at the same time, not one after the other");
  int robots_at_once = 0, seconds = 3600;
  app.add_option("--robots", robots_at_once, "Instead: so many robots along the first walk, again and again");
  app.add_option("--seconds", seconds, "For so long")->capture_default_str();
  app.add_option("WALKS", walks, "SOURCE[ FIRST_FRAME FRAMES] of each robot")->required();
  CLI11_PARSE(app, argc, argv);
  std::vector<TrialRobot> robots;
  for (const std::string& walk : walks) {
    TrialRobot& robot = robots.emplace_back();
    robot.name = "robot" + std::to_string(robots.size());
    std::istringstream words(walk);
    words >> robot.source >> robot.first_frame >> robot.max_frames;
  }
  try {
    if (robots_at_once > 0) {
      options.source = robots.front().source;
      print(run_scale_trial(options, robots_at_once, seconds, config), robots_at_once, seconds);
    } else {
      print(run_atlas_trial(robots, options, config, together));
    }
  } catch (const std::exception& error) {
    std::cerr << "rtd_offline_atlas: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
