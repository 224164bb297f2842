// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Time of depth registration on one core, and how often a copy of the image fits into it (`copies`): what other
// programs do at the same time slows both.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstring>

#include "common/vision/depth_registration.hpp"
#include "tests/support/box_scene.hpp"

namespace {

using rtd::geometry::CameraModel;
using rtd::test::BoxScene;
using rtd::vision::DepthRegistration;

constexpr double kUnit_m = 0.001;

CameraModel pinhole(double f_px, int width, int height) {
  return CameraModel({f_px, f_px, width * 0.5, height * 0.5, {}, width, height});
}
CameraModel with_distortion(double f_px, int width, int height) {
  return CameraModel({f_px, f_px, width * 0.5, height * 0.5, {0.1, -0.2, 0.001, 0.001, 0.05}, width, height});
}

/// A plate before a wall, with the noise and the holes of a sensor.
cv::Mat measured(const CameraModel& camera) {
  cv::Mat depth = BoxScene::plate_before_wall().depth(camera, Eigen::Isometry3d::Identity(), kUnit_m);
  cv::RNG random(7);
  for (auto pixel = depth.begin<std::uint16_t>(); pixel != depth.end<std::uint16_t>(); ++pixel) {
    const double noisy = *pixel + random.gaussian(0.0015 * *pixel * *pixel * kUnit_m);
    *pixel = random.uniform(0, 40) == 0 ? 0 : static_cast<std::uint16_t>(std::max(noisy, 0.0));
  }
  return depth;
}

/// The same bytes, copied into memory that is there already.
double copy_ms(const cv::Mat& image) {
  constexpr int kTimes = 50;
  cv::Mat copy = image.clone();
  double least_ms = 1e9;
  for (int i = 0; i < kTimes; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    std::memcpy(copy.data, image.data, image.total() * image.elemSize());
    benchmark::ClobberMemory();
    least_ms =
        std::min(least_ms, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  return least_ms;
}

void registration(benchmark::State& state, const CameraModel& color, const CameraModel& depth_camera) {
  cv::setNumThreads(1);
  Eigen::Isometry3d T_color_depth = Eigen::Isometry3d::Identity();
  T_color_depth.translation() = Eigen::Vector3d(0.025, 0.001, 0.001);
  T_color_depth.rotate(Eigen::AngleAxisd(0.01, Eigen::Vector3d(1, 1, 1).normalized()));
  const DepthRegistration registered(color, depth_camera, T_color_depth, kUnit_m);
  const cv::Mat depth = measured(depth_camera);
  double least_ms = 1e9;
  for (auto _ : state) {
    const auto begin = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(registered(depth).data);
    least_ms =
        std::min(least_ms, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  state.counters["least_ms"] = least_ms;
  state.counters["copies"] = least_ms / copy_ms(depth);
}

void kinect_640x480(benchmark::State& state) {
  registration(state, pinhole(525, 640, 480), pinhole(580, 640, 480));
}
void distorted_640x480(benchmark::State& state) {
  registration(state, with_distortion(615, 640, 480), with_distortion(580, 640, 480));
}
void d435_640x480(benchmark::State& state) {
  registration(state, pinhole(615, 640, 480), pinhole(385, 640, 480));
}
void depth_848x480_color_1280x720(benchmark::State& state) {
  registration(state, pinhole(920, 1280, 720), pinhole(425, 848, 480));
}
BENCHMARK(kinect_640x480)->Unit(benchmark::kMillisecond);
BENCHMARK(distorted_640x480)->Unit(benchmark::kMillisecond);
BENCHMARK(d435_640x480)->Unit(benchmark::kMillisecond);
BENCHMARK(depth_848x480_color_1280x720)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
