// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/image_table.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "common/service/command_line.hpp"
#include "common/service/config.hpp"
#include "common/service/exit_code.hpp"
#include "common/service/model_locator.hpp"
#include "common/service/run_settings.hpp"
#include "common/vision/image_codecs.hpp"
#include "services/detector/core/detector.hpp"

namespace rtd::detector {
namespace {

void print_row(const std::string& file, const vision::Detection& detection) {
  std::cout << fmt::format("{:<32} {:<14} {:>5.2f} {:>6.0f} {:>6.0f} {:>6.0f} {:>6.0f}\n", file, detection.class_name,
                           detection.score, detection.x_px, detection.y_px, detection.width_px, detection.height_px);
}

int print_files(Detector& detector, const std::vector<std::string>& files) {
  int code = service::kOk;
  std::cout << fmt::format("{:<32} {:<14} {:>5} {:>6} {:>6} {:>6} {:>6}\n", "file", "class", "score", "x_px", "y_px",
                           "width", "height");
  for (const std::string& file : files) {
    const cv::Mat image = vision::read_image(file, {.upright = true}).pixels;
    if (image.empty()) {
      std::cerr << "rtd-detector: " << file << " is missing or not an image\n";
      code = service::kRunFailed;
      continue;
    }
    const std::vector<vision::Detection> detections = detector.detect(image);
    for (const vision::Detection& detection : detections) print_row(file, detection);
    if (detections.empty()) std::cout << fmt::format("{:<32} nothing found\n", file);
  }
  return code;
}

}  // namespace

bool asks_for_image_table(int argc, const char* const* argv) {
  return argc > 1 && std::string_view(argv[1]) == "--image";
}

int print_image_table(int argc, const char* const* argv) {
  CLI::App app{"Prints what is found in image files", "rtd-detector"};
  std::vector<std::string> files;
  std::string model_name;
  DetectorConfig config;
  app.add_option("--image", files, "Image files")->required();
  service::ConfigBinder binder;
  std::vector<service::GivenOption> given;
  service::bind_model(binder, model_name);
  service::bind_engine(binder, config.engine);
  binder.add_options(app, given);
  app.add_option("--confidence", config.decode.confidence_threshold, "Least score")->check(CLI::Range(0.01, 1.0));
  return service::run_command(app, argc, argv, [&] {
    return service::report_errors<std::runtime_error>("rtd-detector", std::cerr, [&] {
      for (const service::GivenOption& option : given) binder.set(option);
      const service::ModelSearch model = service::find_model(model_name, service::process_environment());
      if (!model) throw ModelError(model.message);
      config.model_path = model.path;
      config.onnxruntime = service::find_onnxruntime();
      Detector detector(config);
      return print_files(detector, files);
    });
  });
}

}  // namespace rtd::detector
