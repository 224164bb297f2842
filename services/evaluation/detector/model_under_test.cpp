// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/detector/model_under_test.hpp"

#include <algorithm>
#include <ctime>
#include <filesystem>

#include "common/io/input_file.hpp"
#include "common/io/text.hpp"
#include "common/service/config.hpp"
#include "common/service/model_locator.hpp"
#include "common/vision/samples.hpp"

namespace rtd::eval {
namespace {

namespace fs = std::filesystem;

/// All threads: an engine may have its own.
double process_cpu_ms() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

std::string locate(const std::string& name) {
  const fs::path given(name);
  std::error_code ignored;
  if (fs::is_regular_file(given, ignored)) return name;
  const service::ModelSearch model = service::find_model(name, service::process_environment());
  if (!model) throw service::ConfigError(model.message);
  return model.path;
}

detector::DetectorConfig with_min_score(detector::DetectorConfig config, double least_score) {
  config.decode.confidence_threshold = config.decode.objectness_threshold = least_score;
  return config;
}

/// What `load` loads.
auto load_or_explain(const auto& load) {
  try {
    return load();
  } catch (const detector::ModelError& error) {
    throw service::ConfigError(error.what());
  } catch (const detector::EngineError& error) {
    throw service::ConfigError(std::string("--engine: ") + error.what());
  }
}

}  // namespace

ModelUnderTest::ModelUnderTest(const detector::DetectorConfig& config, double least_score)
    : facts_{.name = fs::path(config.model_path).filename().string(), .engine = config.engine},
      detector_(with_min_score(config, least_score)),
      timed_(config) {
  const std::string bytes = io::try_read_file(config.model_path, io::kNetwork).value_or("");
  const detector::OnnxFile file =
      detector::read_onnx_file(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  facts_.size_mb = static_cast<double>(bytes.size()) * 1e-6;
  facts_.parameters_m = static_cast<double>(file.parameters) * 1e-6;
  facts_.device = detector_.device();
  facts_.input_width_px = detector_.input_size().width_px;
  facts_.input_height_px = detector_.input_size().height_px;
}

std::vector<vision::Detection> ModelUnderTest::detect(const cv::Mat& image) {
  return detector_.detect(image);
}

void ModelUnderTest::take_time(const cv::Mat& image) {
  const double started_ms = process_cpu_ms();
  timed_.detect(image);
  ms_.push_back(process_cpu_ms() - started_ms);
}

ModelFacts ModelUnderTest::facts() const {
  ModelFacts facts = facts_;
  facts.median_ms = vision::median(ms_);
  return facts;
}

std::vector<ModelUnderTest> load_models(const EvalDetectorOptions& options, double least_score) {
  detector::DetectorConfig config;
  config.onnxruntime = service::find_onnxruntime();
  if (!options.names_file.empty()) {
    config.class_names = detector::split_lines(io::try_read_file(options.names_file, io::kLabels).value_or(""));
    if (config.class_names.empty())
      throw service::ConfigError("--names " + options.names_file + ": is missing or empty");
  }
  std::vector<ModelUnderTest> models;
  for (const std::string& name : options.models.empty() ? std::vector<std::string>{""} : options.models) {
    config.model_path = locate(name);
    for (const std::string& engine : options.engines) {
      config.engine = engine;
      models.push_back(load_or_explain([&] { return ModelUnderTest(config, least_score); }));
    }
  }
  return models;
}

std::unique_ptr<detector::PersonSegmenter> load_segmenter(const EvalDetectorOptions& options) {
  if (options.mask_model.empty()) return nullptr;
  detector::MaskConfig config;
  config.model_path = locate(options.mask_model);
  config.engine = options.engines.front();
  config.onnxruntime = service::find_onnxruntime();
  return load_or_explain([&] { return std::make_unique<detector::PersonSegmenter>(config); });
}

}  // namespace rtd::eval
