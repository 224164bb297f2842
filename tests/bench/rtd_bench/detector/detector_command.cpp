// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/rtd_bench/detector/detector_command.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <ostream>

#include "common/camera/open/source_factory.hpp"
#include "common/msg/engine_names.hpp"
#include "common/service/command_line.hpp"
#include "common/service/config.hpp"
#include "common/service/model_locator.hpp"
#include "services/detector/core/detector.hpp"

namespace rtd::bench {
namespace {

constexpr const char* kRenderedScene = "synthetic:office";

/// The files of a folder that are images, by name. Throws service::ConfigError without one.
std::vector<cv::Mat> read_folder(const std::string& folder, std::size_t most) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored))
    throw service::ConfigError("--images " + folder + ": there is no such folder");
  std::vector<std::string> files;
  cv::glob(folder, files);
  std::ranges::sort(files);
  std::vector<cv::Mat> images;
  for (const std::string& file : files) {
    if (images.size() == most) break;
    if (cv::Mat image = cv::imread(file); !image.empty()) images.push_back(std::move(image));
  }
  if (images.empty()) throw service::ConfigError("--images " + folder + ": has no images (jpg, png, ...)");
  return images;
}

std::vector<cv::Mat> render_images(std::size_t count) {
  const auto source = camera::make_source(kRenderedScene);
  std::vector<cv::Mat> images;
  while (images.size() < count) {
    const auto frame = source->next();
    if (!frame) break;
    images.push_back(frame->image.color_bgr.clone());
  }
  return images;
}

DetectorOptions complete(DetectorRequest& request) {
  const service::EnvironmentReader environment = service::process_environment();
  const service::ModelSearch model = service::find_model(request.model, environment);
  if (!model) throw service::ConfigError(model.message);
  DetectorOptions options = request.options;
  options.model_path = model.path;
  options.onnxruntime = service::find_onnxruntime();
  return options;
}

void write_to(const std::string& file, const std::string& text, const std::string& option) {
  if (file.empty()) return;
  if (!(std::ofstream(file) << text << std::flush))
    throw service::ConfigError(option + " " + file + ": cannot be written; check that its folder exists");
}

void serve_robots(std::span<const cv::Mat> images, const DetectorOptions& options, const FleetLoad& load,
                  DetectorComparison& comparison, std::ostream& err) {
  service::Progress progress(err, "cases with robots", cases_of(options, load));
  comparison.load = load;
  comparison.fleet = bench_fleet(images, options, load, [&] { progress.advance(); });
}

int compare_engines(DetectorRequest& request, std::ostream& out, std::ostream& err) {
  const DetectorOptions options = complete(request);
  write_to(request.json_file, "", "--json");  // before the long work, so that a wrong path does not waste it
  const std::vector<cv::Mat> images =
      request.image_folder.empty() ? render_images(request.frames) : read_folder(request.image_folder, request.frames);
  service::Progress progress(err, "batches", batches_of(images.size(), options));
  DetectorComparison comparison = bench_detector(images, options, [&] { progress.advance(); });
  serve_robots(images, options, request.load, comparison, err);
  out << detector_table(comparison) << fleet_table(comparison.fleet, comparison.load);
  write_to(request.json_file, detector_json(comparison), "--json");
  const auto failed = [](const auto& result) { return !result.failure.empty(); };
  return std::ranges::any_of(comparison.cases, failed) || std::ranges::any_of(comparison.fleet, failed)
             ? service::kRunFailed
             : service::kOk;
}

}  // namespace

void add_detector_command(CLI::App& app, DetectorRequest& request) {
  DetectorOptions& options = request.options;
  CLI::App* bench = app.add_subcommand("detector", "Time of the detector's engines by batch size, and their boxes");
  bench->add_option("--engines", options.engines, msg::kEngineNames)->delimiter(',')->capture_default_str();
  bench->add_option("--batch", options.batches, "Images that are computed at once; more than 1 needs a free batch")
      ->delimiter(',')
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  bench->add_option("--model", request.model, "ONNX file (default: the usual model)");
  bench->add_option("--images", request.image_folder, "Folder of images (default: a rendered office)");
  bench->add_option("--frames", request.frames, "Number of images at most (they are read before the measurement)")
      ->check(CLI::Range(1, 2000))
      ->capture_default_str();
  bench->add_option("--threads", options.threads, "Threads of engines that compute on the CPU")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  bench->add_option("--robots", request.load.robots, "Then also serve so many robots by their JPEG images, e.g. 1,8,30")
      ->delimiter(',')
      ->check(CLI::Range(1, 1000));
  bench->add_option("--rate", request.load.rate_hz, "Images a second of each robot")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  bench->add_option("--seconds", request.load.seconds, "Time of each case with robots")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  bench->add_option("--json", request.json_file, "Also write all figures into this file");
}

std::optional<int> run_detector(const CLI::App& app, DetectorRequest& request, std::ostream& out, std::ostream& err) {
  if (!app.got_subcommand("detector")) return std::nullopt;
  return service::report_errors<service::ConfigError, detector::ModelError, detector::EngineError>(
      "rtd bench", err, [&] { return compare_engines(request, out, err); });
}

}  // namespace rtd::bench
