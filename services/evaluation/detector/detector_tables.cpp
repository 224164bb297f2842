// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/detector/detector_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace rtd::eval {
namespace {

constexpr std::size_t kShownProblems = 10;

std::string model_rows(const LabelledResults& results) {
  std::string text =
      fmt::format("{:<28} {:>9} {:>7} {:>9} {:>7} {:>7} {:>9} {:>12} {:>9} {:>9} {:>9}\n", "model", "input", "MB",
                  "params M", "ms", "AP50", "AP50:95", "person AP50", "high", "medium", "low");
  for (const LabelledResult& result : results.models) {
    const ModelFacts& model = result.model;
    text += fmt::format("{:<28} {:>9} {:>7.2f} {:>9.3f} {:>7.1f} {:>7.3f} {:>9.3f} {:>12.3f}", model.name,
                        fmt::format("{}x{}", model.input_width_px, model.input_height_px), model.size_mb,
                        model.parameters_m, model.median_ms, result.accuracy.ap50, result.accuracy.ap50_95,
                        result.accuracy.person.ap50());
    for (const char* level : {"high", "medium", "low"}) {
      const auto found = result.accuracy.groups.find(level);
      text += found == result.accuracy.groups.end() ? fmt::format(" {:>9}", "-")
                                                    : fmt::format(" {:>9.3f}", found->second.ap50());
    }
    text += '\n';
  }
  return text +
         "ms: median CPU time of one image on one thread; high, medium, low: AP50 of all classes of a motion level "
         "taken as one\n";
}

std::string point_text(const std::optional<detector::OperatingPoint>& point) {
  if (!point) return "-";
  return fmt::format("{:.3f} (P {:.2f} R {:.2f} F1 {:.2f})", point->threshold, point->precision, point->recall,
                     point->f1);
}

std::string threshold_rows(const LabelledResults& results) {
  const std::string wanted = fmt::format("recall {:.2f}", results.wanted_recall);
  std::string text = fmt::format("\nconfidence threshold, high level\n{:<28} {:<36} {:<36} {}\n", "model", "best F1",
                                 wanted, "default");
  const double usual = detector::DecodeConfig{}.confidence_threshold;
  for (const LabelledResult& result : results.models) {
    const auto high = result.accuracy.groups.find("high");
    if (high == result.accuracy.groups.end()) continue;
    const auto& curve = high->second.curve;
    text += fmt::format("{:<28} {:<36} {:<36} {}\n", result.model.name, point_text(best_f1(curve)),
                        point_text(highest_threshold_with_recall(curve, results.wanted_recall)),
                        point_text(at_threshold(curve, usual)));
  }
  return text;
}

std::string recall_row(const std::string& name, double roll_deg, double threshold, const detector::MaskRecall& recall) {
  return fmt::format("{:<36} {:>6.0f} {:>10.2f} {:>12.3f} {:>14.3f} {:>9.3f} {:>8} {:>8}\n", name, roll_deg, threshold,
                     recall.pixel_recall(), recall.image_share(),
                     recall.people == 0 ? 1 : double(recall.people_found) / double(recall.people), recall.boxes,
                     recall.boxes_beside);
}

std::string recall_rows(const std::string& name, const RecallByRoll& by_roll) {
  std::string text;
  for (const auto& [roll_deg, by_threshold] : by_roll)
    for (const auto& [threshold, recall] : by_threshold) text += recall_row(name, roll_deg, threshold, recall);
  return text;
}

}  // namespace

std::string labelled_table(const LabelledResults& results) {
  return model_rows(results) + threshold_rows(results);
}

std::string mask_table(const MaskResults& results) {
  std::string text = fmt::format("{:<36} {:>6} {:>10} {:>12} {:>14} {:>9} {:>8} {:>8}\n", "model", "roll", "confidence",
                                 "pixel recall", "images complete", "people", "boxes", "beside");
  for (const MaskResult& result : results.models) {
    text += recall_rows(result.model.name, result.as_seen);
    text += recall_rows(result.model.name + " upright", result.upright);
  }
  return text +
         "images complete: every marked area (400 px or more) has half of its pixels in boxes; beside: boxes on "
         "nothing marked\n";
}

std::string input_lines(const InputReport& input, const std::string& partner) {
  std::string text = fmt::format("{} images", input.images);
  if (input.without_partner > 0) text += fmt::format(", {} {}", input.without_partner, partner);
  if (input.not_decoded > 0) text += fmt::format(", {} left out", input.not_decoded);
  text += '\n';
  for (std::size_t i = 0; i < std::min(input.problems.size(), kShownProblems); ++i)
    text += "  " + input.problems[i] + '\n';
  if (input.problems.size() > kShownProblems) {
    text += fmt::format("  and {} more (--json lists all)\n", input.problems.size() - kShownProblems);
  }
  return text;
}

}  // namespace rtd::eval
