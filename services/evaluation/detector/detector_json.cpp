// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/detector/detector_report.hpp"

#include <optional>

namespace rtd::eval {
namespace {

using nlohmann::json;

constexpr int kCurveSteps = 100;  // thresholds 0.01 .. 0.99

json input_json(const InputReport& input) {
  return {{"images", input.images},
          {"without_partner", input.without_partner},
          {"not_decoded", input.not_decoded},
          {"problems", input.problems}};
}

json model_json(const ModelFacts& model) {
  return {{"name", model.name},
          {"size_mb", model.size_mb},
          {"parameters_m", model.parameters_m},
          {"input_width_px", model.input_width_px},
          {"input_height_px", model.input_height_px},
          {"median_ms", model.median_ms > 0 ? json(model.median_ms) : json()}};
}

json point_json(const std::optional<detector::OperatingPoint>& point) {
  if (!point) return {};
  return {
      {"threshold", point->threshold}, {"precision", point->precision}, {"recall", point->recall}, {"f1", point->f1}};
}

json boxes_json(const detector::BoxAccuracy& accuracy) {
  return {{"objects", accuracy.truths},
          {"detections", accuracy.detections},
          {"ap50", accuracy.ap50()},
          {"ap50_95", accuracy.ap50_95()},
          {"ap_by_iou", accuracy.ap}};
}

json group_json(const detector::BoxAccuracy& accuracy, double wanted_recall) {
  json group = boxes_json(accuracy);
  group["best_f1"] = point_json(best_f1(accuracy.curve));
  group["wanted_recall"] = point_json(highest_threshold_with_recall(accuracy.curve, wanted_recall));
  group["curve"] = json::array();
  for (int i = 1; i < kCurveSteps; ++i)
    group["curve"].push_back(point_json(at_threshold(accuracy.curve, i / double(kCurveSteps))));
  return group;
}

json recall_json(const RecallByRoll& by_roll) {
  json rows = json::array();
  for (const auto& [roll_deg, by_threshold] : by_roll)
    for (const auto& [threshold, recall] : by_threshold) {
      rows.push_back({{"roll_deg", roll_deg},
                      {"threshold", threshold},
                      {"pixel_recall", recall.pixel_recall()},
                      {"images_complete", recall.image_share()},
                      {"people", recall.people},
                      {"people_found", recall.people_found},
                      {"boxes", recall.boxes},
                      {"boxes_beside", recall.boxes_beside}});
    }
  return rows;
}

}  // namespace

json to_json(const LabelledResults& results) {
  json document = {{"input", input_json(results.input)},
                   {"label_format", results.format},
                   {"wanted_recall", results.wanted_recall},
                   {"models", json::array()}};
  for (const LabelledResult& result : results.models) {
    json entry = model_json(result.model);
    entry["ap50"] = result.accuracy.ap50;
    entry["ap50_95"] = result.accuracy.ap50_95;
    for (const auto& [name, accuracy] : result.accuracy.classes) entry["classes"][name] = boxes_json(accuracy);
    for (const auto& [name, accuracy] : result.accuracy.groups) {
      entry["levels"][name] = group_json(accuracy, results.wanted_recall);
    }
    document["models"].push_back(entry);
  }
  return document;
}

json to_json(const MaskResults& results) {
  json document = {{"input", input_json(results.input)}, {"models", json::array()}};
  for (const MaskResult& result : results.models) {
    json entry = model_json(result.model);
    entry["as_seen"] = recall_json(result.as_seen);
    entry["upright"] = recall_json(result.upright);
    document["models"].push_back(entry);
  }
  return document;
}

}  // namespace rtd::eval
