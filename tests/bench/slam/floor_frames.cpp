// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// rtd_floor_frames SOURCE...: which way is up by the floor of single frames, with a camera assumed level? Angles to the
// true up direction, and whether the reported deviations are true. docs/results.md, "Which way is up".
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/camera/open/source_factory.hpp"
#include "services/slam/core/floor_plane.hpp"
#include "services/slam/core/map/frame.hpp"
#include "tests/support/offline_pipeline.hpp"

namespace {

using namespace rtd;

constexpr double kDegPerRad = 180 / std::numbers::pi;

struct Options {
  std::vector<std::string> sources;
  std::size_t every = 5, frames = 325;
};

/// Of the frames of one source; degrees.
struct Score {
  std::size_t frames = 0, found = 0, within = 0;  ///< within three of the reported deviations
  double squares = 0, worst = 0, worst_ratio = 0;
  double first = 0, first_sigma = 0;
  std::size_t first_frame = 0;

  void add(std::size_t frame, double error, double sigma) {
    if (found++ == 0) {
      first = error;
      first_sigma = sigma;
      first_frame = frame;
    }
    squares += error * error;
    worst = std::max(worst, error);
    worst_ratio = std::max(worst_ratio, error / sigma);
    within += error <= 3 * sigma ? 1 : 0;
  }
};

std::optional<slam::FloorPlane> floor_of(const camera::SourceFrame& frame, test_support::FrontEnd& front_end) {
  const slam::SensorConfig sensor;
  const auto message = test_support::make_feature_frame(frame.image, front_end.process(frame).features);
  const slam::FramePtr features = slam::make_frame(*message, sensor).frame;
  if (features == nullptr) return std::nullopt;
  const Eigen::Vector3d level_up(0, -1, 0);
  return slam::find_floor(features->unproject_all(), level_up, sensor.calibration_error);
}

Score judge(const std::string& uri, const Options& options) {
  const auto source = camera::make_source(uri);
  Score score;
  std::unique_ptr<test_support::FrontEnd> front_end;
  for (std::size_t i = 0; i < options.frames; ++i) {
    const auto frame = source->next();
    if (!frame) break;
    if (i % options.every != 0) continue;
    const auto T_world_camera =
        frame->T_world_camera ? frame->T_world_camera : source->true_pose(frame->image.stamp_ns);
    if (!T_world_camera) continue;
    if (!front_end)
      front_end = test_support::make_front_end({frame->dynamic_mask.empty() ? "off" : "true-mask", {}, {}});
    ++score.frames;
    const auto floor = floor_of(*frame, *front_end);
    if (!floor) continue;
    const Eigen::Vector3d up_camera = T_world_camera->linear().transpose() * Eigen::Vector3d::UnitZ();
    const double error_rad = std::acos(std::min(1.0, floor->up_camera.dot(up_camera)));
    score.add(i, kDegPerRad * error_rad, kDegPerRad * floor->sigma_rad);
  }
  return score;
}

void print(const std::string& name, const Score& score) {
  if (score.found == 0) {
    std::printf("%-40s none found in %zu\n", name.c_str(), score.frames);
    return;
  }
  std::printf("%-40s %5.2f (%.2f) %4zu %6.2f %6.2f  %3zu / %3zu   %.3f %5.1f\n", name.c_str(), score.first,
              score.first_sigma, score.first_frame, std::sqrt(score.squares / static_cast<double>(score.found)),
              score.worst, score.found, score.frames,
              static_cast<double>(score.within) / static_cast<double>(score.found), score.worst_ratio);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"The up direction by the floor of single frames"};
  Options options;
  app.add_option("sources", options.sources, "URIs as rtd-camera takes them, with true poses")->required();
  app.add_option("--every", options.every, "take each n-th frame")->check(CLI::Range(1, 10000));
  app.add_option("--frames", options.frames, "of each source");
  CLI11_PARSE(app, argc, argv);
  std::printf("%-40s first (sigma) frame   RMS  worst  found       in 3 sigma, worst ratio\n", "degrees");
  try {
    for (const std::string& uri : options.sources) print(uri, judge(uri, options));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
