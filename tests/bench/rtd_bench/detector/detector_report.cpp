// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/service/json_text.hpp"
#include "tests/bench/rtd_bench/detector/detector_bench.hpp"
#include "tests/bench/rtd_bench/percentile.hpp"

namespace rtd::bench {
namespace {

std::string case_row(const DetectorResult& result) {
  const std::string head = fmt::format("{:<16} {:>5}", detector::engine_label(result.what.engine), result.what.batch);
  if (!result.failure.empty()) return fmt::format("{}  {}\n", head, result.failure);
  const detector::AgreementCount& same = result.same;
  const std::string difference = same.first_difference.empty() ? "" : "; first difference: " + same.first_difference;
  return fmt::format("{} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>11}  {}{}\n", head, result.ms_per_image(),
                     percentile(result.batch_ms, 50), percentile(result.batch_ms, 99), result.images_per_s(),
                     result.cpu_ms_per_image, fmt::format("{} of {}", same.agreeing, same.images), result.device,
                     difference);
}

nlohmann::json case_json(const DetectorResult& result) {
  nlohmann::json json{{"engine", result.what.engine}, {"batch", result.what.batch}};
  if (!result.failure.empty()) {
    json["failure"] = result.failure;
    return json;
  }
  json["device"] = result.device;
  json["load_s"] = result.load_s;
  json["ms_per_image"] = result.ms_per_image();
  json["batch_ms"] = {{"p50", percentile(result.batch_ms, 50)},
                      {"p99", percentile(result.batch_ms, 99)},
                      {"samples", result.batch_ms.size()}};
  json["images_per_s"] = result.images_per_s();
  json["cpu_ms_per_image"] = result.cpu_ms_per_image;
  json["boxes"] = result.boxes;
  json["agreement"] = {{"images", result.same.images},
                       {"agreeing", result.same.agreeing},
                       {"first_difference", result.same.first_difference}};
  return json;
}

nlohmann::json fleet_json(const FleetResult& result, const FleetLoad& load) {
  nlohmann::json json{{"engine", result.engine}, {"batch", result.batch}, {"robots", result.robots}};
  if (!result.failure.empty()) {
    json["failure"] = result.failure;
    return json;
  }
  json["device"] = result.device;
  json["sent_hz"] = load.rate_hz;
  json["answered_hz"] = {{"mean", result.mean_hz}, {"least", result.least_hz}};
  json["latency_ms"] = {{"p50", result.latency_p50_ms}, {"p99", result.latency_p99_ms}};
  json["batch_mean"] = result.batch_mean;
  json["images_per_s"] = result.images_per_s();
  json["cpu_percent"] = result.cpu_percent;
  return json;
}

}  // namespace

std::string detector_table(const DetectorComparison& comparison) {
  const detector::AgreementLimits limits;
  std::string text =
      fmt::format("{}, {}x{}, {} image{}, from image to boxes; engines on the CPU: {} thread{}\n\n", comparison.model,
                  comparison.input.width_px, comparison.input.height_px, comparison.images,
                  comparison.images == 1 ? "" : "s", comparison.threads, comparison.threads == 1 ? "" : "s");
  text += fmt::format("{:<16} {:>5} {:>9} {:>9} {:>9} {:>9} {:>9} {:>11}  {}\n", "engine", "batch", "ms/image",
                      "batch p50", "batch p99", "images/s", "CPU ms", "same boxes", "device");
  for (const DetectorResult& result : comparison.cases) text += case_row(result);
  return text +
         fmt::format(
             "\nCPU ms: CPU time of an image, all threads of this process; same boxes: images on which all boxes lie "
             "within {:g} px and {:g} of\nthe score of those of engine cpu, one image at a time\n",
             limits.box_px, limits.score);
}

std::string detector_json(const DetectorComparison& comparison) {
  nlohmann::json json{{"model", comparison.model},
                      {"input_width_px", comparison.input.width_px},
                      {"input_height_px", comparison.input.height_px},
                      {"images", comparison.images},
                      {"threads", comparison.threads},
                      {"cases", nlohmann::json::array()}};
  for (const DetectorResult& result : comparison.cases) json["cases"].push_back(case_json(result));
  for (const FleetResult& result : comparison.fleet) json["robots"].push_back(fleet_json(result, comparison.load));
  return service::json_text(json) + '\n';
}

}  // namespace rtd::bench
