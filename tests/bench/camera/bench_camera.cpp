// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <memory>
#include <opencv2/imgcodecs.hpp>

#include "common/camera/source_factory.hpp"
#include "services/camera/frame_publisher.hpp"

namespace {

using rtd::camera::make_source;

void play(benchmark::State& state, const std::string& uri) {
  auto source = make_source(uri);
  for (auto _ : state) {
    auto frame = source->next();
    if (!frame) {
      state.PauseTiming();
      source = make_source(uri);
      state.ResumeTiming();
      frame = source->next();
    }
    benchmark::DoNotOptimize(frame->image.depth.data);
  }
}

/// Decoding one JPEG + PNG pair of a real clip.
void decode_fr1_xyz(benchmark::State& state) {
  const char* folder = std::getenv("RTD_DATA_DIR");
  if (folder == nullptr) return state.SkipWithError("set RTD_DATA_DIR");
  play(state, std::string("tum:") + folder + "/fr1_xyz");
}
BENCHMARK(decode_fr1_xyz)->Unit(benchmark::kMillisecond);

void render_static(benchmark::State& state) {
  play(state, "synthetic:static?frames=0");
}
BENCHMARK(render_static)->Unit(benchmark::kMillisecond);
void render_office(benchmark::State& state) {
  play(state, "synthetic:office?frames=0");
}
BENCHMARK(render_office)->Unit(benchmark::kMillisecond);
void render_crowd(benchmark::State& state) {
  play(state, "synthetic:crowd?frames=0");
}
BENCHMARK(render_crowd)->Unit(benchmark::kMillisecond);

void open_synthetic(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(make_source("synthetic:office"));
}
BENCHMARK(open_synthetic)->Unit(benchmark::kMillisecond);

void fill_frame(benchmark::State& state) {
  const auto frame = make_source("synthetic:static?frames=1")->next();
  const auto message = std::make_unique<rtd::msg::RgbdFrame>();
  for (auto _ : state) {
    rtd::camera::fill_frame(frame->image, 1, 2, *message);
    benchmark::ClobberMemory();
  }
}
BENCHMARK(fill_frame)->Unit(benchmark::kMillisecond);

void encode_jpeg_90(benchmark::State& state) {
  const auto frame = make_source("synthetic:static?frames=1")->next();
  std::vector<std::uint8_t> bytes;
  for (auto _ : state) cv::imencode(".jpg", frame->image.color_bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, 90});
  state.counters["bytes"] = static_cast<double>(bytes.size());
}
BENCHMARK(encode_jpeg_90)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
