// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Hours in one room, faster than real time: does slam's memory stay level once the room is known, and its time?
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "common/msg/transform_eigen.hpp"
#include "common/vision/samples.hpp"
#include "services/slam/core/slam_system.hpp"
#include "tests/support/feature_world.hpp"

namespace {

using rtd::test_support::FeatureWorld;

constexpr std::uint64_t kFramesPerMinute = 30 * 60;
constexpr double kRoundS = 60;  ///< once through the room

std::int64_t cpu_ns() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

double resident_mb() {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("RssAnon:")) return std::stod(line.substr(8)) / 1024;
  }
  return 0;
}

/// To and fro through the room, never twice the same way: identity at seq 0.
Eigen::Isometry3d T_world_camera(std::uint64_t seq) {
  const double t_s = static_cast<double>(seq) / 30, round = 2 * M_PI * t_s / kRoundS;
  Eigen::Isometry3d T_room_hand = Eigen::Isometry3d::Identity();
  T_room_hand.translation() = Eigen::Vector3d(1.2 * std::sin(round), 0, 0.3 * (1 - std::cos(0.37 * round)));
  T_room_hand.linear() = Eigen::AngleAxisd(0.35 * std::sin(1.3 * round), Eigen::Vector3d::UnitY()).toRotationMatrix();
  return T_room_hand * FeatureWorld::T_world_camera(seq);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("RTD-SLAM soak: hours of simulated motion through one room, slam alone");
  double minutes = 480;
  int points = 1500, rows = 12;
  app.add_option("--minutes", minutes, "simulated time")->check(CLI::Range(0.1, 1e5));
  app.add_option("--points", points, "of the world; a third of them is in view")->check(CLI::Range(300, 20'000));
  app.add_option("--rows", rows, "of the table")->check(CLI::Range(2, 1000));
  CLI11_PARSE(app, argc, argv);
  FeatureWorld::Options options;
  options.points = points;
  options.noise_px = 0.5;
  options.depth_noise_factor = 0.0015;
  options.flipped_bits = 12;
  const FeatureWorld world(options);
  rtd::slam::SlamSystem slam({}, rtd::slam::MappingMode::kSynchronous, cpu_ns);
  const auto frames = static_cast<std::uint64_t>(minutes * kFramesPerMinute);
  const std::uint64_t per_row = std::max<std::uint64_t>(1, frames / static_cast<std::uint64_t>(rows));
  std::printf(
      "| simulated min | keyframes (ever) | landmarks (ever) | memory, MB | tracking, ms | with mapping, ms | error, "
      "mm | not ok |\n"
      "|---|---|---|---|---|---|---|---|\n");
  std::vector<double> tracking_ms, total_ms;
  double error2_m2 = 0;
  std::uint64_t lost = 0;
  for (std::uint64_t seq = 0; seq < frames; ++seq) {
    const auto view = world.view(seq, T_world_camera(seq));
    const rtd::slam::SlamOutput output = slam.process(*view);
    const auto& stage = output.result.stage_ms;
    tracking_ms.push_back(static_cast<double>(stage[rtd::msg::kStageSlamTotal] - stage[rtd::msg::kStageMapping]));
    total_ms.push_back(static_cast<double>(stage[rtd::msg::kStageSlamTotal]));
    lost += output.result.state == rtd::msg::TrackingState::kOk ? 0 : 1;
    error2_m2 += (output.result.T_world_camera.translation() - T_world_camera(seq).translation()).squaredNorm();
    if ((seq + 1) % per_row != 0) continue;
    double mean_ms = 0;
    for (const double ms : total_ms) mean_ms += ms / static_cast<double>(total_ms.size());
    std::size_t keyframes = 0, landmarks = 0;
    slam.read_map([&](const rtd::slam::Map& map) {
      keyframes = map.next_keyframe();
      landmarks = static_cast<std::size_t>(map.next_landmark());
    });
    std::printf("| %.0f | %u (%zu) | %u (%zu) | %.1f | %.2f | %.2f | %.1f | %lu |\n",
                static_cast<double>(seq + 1) / kFramesPerMinute, output.result.keyframes, keyframes,
                output.result.landmarks, landmarks, resident_mb(), rtd::vision::median(tracking_ms), mean_ms,
                1e3 * std::sqrt(error2_m2 / static_cast<double>(tracking_ms.size())), lost);
    std::fflush(stdout);
    tracking_ms.clear();
    total_ms.clear();
    error2_m2 = 0;
  }
  return 0;
}
