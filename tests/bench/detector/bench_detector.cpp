// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Times of the detector on one thread, and of masks of two people. Needs the weights; RTD_DATA_DIR gives a real image.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "common/service/model_locator.hpp"
#include "services/detector/core/detector.hpp"
#include "services/detector/core/person_segmenter.hpp"
#include "tests/support/detector/mask_network.hpp"

namespace rtd::detector {
namespace {

/// The network and the engine of docs/results.md.
DetectorConfig config_or_skip(benchmark::State& state) {
  const service::ModelSearch model = service::find_model(service::kPaperModel, service::process_environment());
  if (!model) state.SkipWithError(model.message.c_str());
  DetectorConfig config;
  config.model_path = model.path;
  config.engine = "cpu";
  return config;
}

/// An office with two people; noise when there is no data.
cv::Mat test_image() {
  const char* const data = std::getenv("RTD_DATA_DIR");
  cv::Mat image;
  if (data != nullptr) image = cv::imread((std::filesystem::path(data) / "people_stills/rgb/img2.jpg").string());
  if (image.empty()) {
    image.create(480, 640, CV_8UC3);
    cv::randu(image, 0, 255);
  }
  return image;
}

void detect(benchmark::State& state) {
  const DetectorConfig config = config_or_skip(state);
  if (config.model_path.empty()) return;
  Detector detector(config);
  const cv::Mat image = test_image();
  for (auto _ : state) benchmark::DoNotOptimize(detector.detect(image));
}
BENCHMARK(detect)->Unit(benchmark::kMillisecond)->MinTime(2);

/// Each network for boxes with ONNX Runtime.
void detect_with_onnxruntime(benchmark::State& state, const char* model) {
  const service::ModelSearch found = service::find_model(model, service::process_environment());
  if (!found || !knows_onnxruntime()) return state.SkipWithError("needs weights and ONNX Runtime");
  DetectorConfig config;
  config.model_path = found.path;
  config.engine = "onnxruntime:" ONNXRUNTIME_LIBRARY;
  Detector detector(config);
  const cv::Mat image = test_image();
  for (auto _ : state) benchmark::DoNotOptimize(detector.detect(image));
}
BENCHMARK_CAPTURE(detect_with_onnxruntime, yolov5_lite, "yolov5-lite")->Unit(benchmark::kMillisecond)->MinTime(2);
BENCHMARK_CAPTURE(detect_with_onnxruntime, yolox_nano, "yolox-nano")->Unit(benchmark::kMillisecond)->MinTime(2);

/// Masks of two people alone; detect_with_onnxruntime is what their boxes take.
void two_masks(benchmark::State& state, const char* engine) {
  MaskConfig config;
  config.model_path = test::mask_network();
  config.engine = engine;
  if (config.model_path.empty() || (config.engine != "cpu" && !knows_onnxruntime()))
    return state.SkipWithError("needs the network for masks and, for its engine, ONNX Runtime");
  PersonSegmenter segmenter(config);
  const cv::Mat image = test_image();
  const std::vector<vision::Detection> people = {{"person", 0.9F, 325, 54, 152, 426},
                                                 {"person", 0.9F, 473, 206, 128, 267}};
  for (auto _ : state) benchmark::DoNotOptimize(segmenter.segment(image, people, 2));
}
BENCHMARK_CAPTURE(two_masks, onnxruntime, "onnxruntime:" ONNXRUNTIME_LIBRARY)
    ->Unit(benchmark::kMillisecond)
    ->MinTime(2);
BENCHMARK_CAPTURE(two_masks, opencv, "cpu")->Unit(benchmark::kMillisecond)->MinTime(2);

}  // namespace
}  // namespace rtd::detector

BENCHMARK_MAIN();
