// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/detector/eval_detector_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>

#include "common/io/atomic_file.hpp"
#include "common/msg/engine_names.hpp"
#include "common/service/json_text.hpp"
#include "services/evaluation/commands/guarded.hpp"
#include "services/evaluation/detector/evaluate.hpp"

namespace rtd::eval {
namespace {

using Json = nlohmann::json;

constexpr int kCurveSteps = 100;  // thresholds 0.01 .. 0.99

Json input_json(const InputReport& input) {
  return {{"images", input.images},
          {"without_partner", input.without_partner},
          {"not_decoded", input.not_decoded},
          {"problems", input.problems}};
}

Json model_json(const ModelFacts& model) {
  return {{"name", model.name},
          {"engine", model.engine},
          {"device", model.device},
          {"size_mb", model.size_mb},
          {"parameters_m", model.parameters_m},
          {"input_width_px", model.input_width_px},
          {"input_height_px", model.input_height_px},
          {"median_ms", model.median_ms > 0 ? Json(model.median_ms) : Json()}};
}

Json agreement_json(const detector::AgreementCount& count) {
  return {{"images", count.images}, {"agreeing", count.agreeing}, {"first_difference", count.first_difference}};
}

Json point_json(const std::optional<OperatingPoint>& point) {
  if (!point) return {};
  return {
      {"threshold", point->threshold}, {"precision", point->precision}, {"recall", point->recall}, {"f1", point->f1}};
}

Json boxes_json(const BoxAccuracy& accuracy) {
  return {{"objects", accuracy.truths},
          {"detections", accuracy.detections},
          {"ap50", accuracy.ap50()},
          {"ap50_95", accuracy.ap50_95()},
          {"ap_by_iou", accuracy.ap}};
}

Json group_json(const BoxAccuracy& accuracy, double wanted_recall) {
  Json group = boxes_json(accuracy);
  group["best_f1"] = point_json(best_f1(accuracy.curve));
  group["wanted_recall"] = point_json(highest_threshold_with_recall(accuracy.curve, wanted_recall));
  group["curve"] = Json::array();
  for (int i = 1; i < kCurveSteps; ++i)
    group["curve"].push_back(point_json(at_threshold(accuracy.curve, i / double(kCurveSteps))));
  return group;
}

Json recall_json(const RecallByRoll& by_roll) {
  Json rows = Json::array();
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

constexpr std::size_t kShownProblems = 10;

std::string model_rows(const LabelledResults& results) {
  std::string text =
      fmt::format("{:<36} {:>9} {:>7} {:>9} {:>7} {:>7} {:>9} {:>12} {:>9} {:>9} {:>9}\n", "model", "input", "MB",
                  "params M", "ms", "AP50", "AP50:95", "person AP50", "high", "medium", "low");
  for (const LabelledResult& result : results.models) {
    const ModelFacts& model = result.model;
    text += fmt::format("{:<36} {:>9} {:>7.2f} {:>9.3f} {:>7.1f} {:>7.3f} {:>9.3f} {:>12.3f}", model.title(),
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
         "ms: median CPU time of one image, all threads; high, medium, low: AP50 of all classes of a motion level "
         "taken as one\n";
}

std::string point_text(const std::optional<OperatingPoint>& point) {
  if (!point) return "-";
  return fmt::format("{:.3f} (P {:.2f} R {:.2f} F1 {:.2f})", point->threshold, point->precision, point->recall,
                     point->f1);
}

std::string threshold_rows(const LabelledResults& results) {
  const std::string wanted = fmt::format("recall {:.2f}", results.wanted_recall);
  std::string text = fmt::format("\nconfidence threshold, high level\n{:<36} {:<36} {:<36} {}\n", "model", "best F1",
                                 wanted, "default");
  const double usual = detector::DecodeConfig{}.confidence_threshold;
  for (const LabelledResult& result : results.models) {
    const auto high = result.accuracy.groups.find("high");
    if (high == result.accuracy.groups.end()) continue;
    const auto& curve = high->second.curve;
    text += fmt::format("{:<36} {:<36} {:<36} {}\n", result.model.title(), point_text(best_f1(curve)),
                        point_text(highest_threshold_with_recall(curve, results.wanted_recall)),
                        point_text(at_threshold(curve, usual)));
  }
  return text;
}

/// What the other engines find next to the CPU; nothing when only the CPU was asked for.
std::string agreement_rows(const LabelledResults& results) {
  std::string rows;
  for (const LabelledResult& result : results.models) {
    if (!result.agreement) continue;
    const detector::AgreementCount& count = *result.agreement;
    rows += fmt::format("{:<36} {} of {} images on {}{}\n", result.model.title(), count.agreeing, count.images,
                        result.model.device,
                        count.first_difference.empty() ? "" : "; first difference: " + count.first_difference);
  }
  if (rows.empty()) return rows;
  const detector::AgreementLimits limits;
  return fmt::format("\nsame boxes as the CPU: score {:g} or more, within {:g} px and {:g}\n",
                     detector::DecodeConfig{}.confidence_threshold, limits.box_px, limits.score) +
         rows;
}

std::string recall_rows(const std::string& name, const RecallByRoll& by_roll) {
  std::string text;
  for (const auto& [roll_deg, by_threshold] : by_roll)
    for (const auto& [threshold, recall] : by_threshold)
      text += fmt::format("{:<36} {:>6.0f} {:>10.2f} {:>12.3f} {:>14.3f} {:>9.3f} {:>8} {:>8}\n", name, roll_deg,
                          threshold, recall.pixel_recall(), recall.image_share(),
                          recall.people == 0 ? 1 : double(recall.people_found) / double(recall.people), recall.boxes,
                          recall.boxes_beside);
  return text;
}

Json overlap_json(const std::map<double, MaskOverlap>& by_roll) {
  Json rows = Json::array();
  for (const auto& [roll_deg, overlap] : by_roll) {
    rows.push_back({{"roll_deg", roll_deg},
                    {"iou", overlap.iou()},
                    {"precision", overlap.precision()},
                    {"recall", overlap.recall()},
                    {"box_precision", overlap.box_precision()}});
  }
  return rows;
}

std::string overlap_rows(const std::vector<MaskResult>& models) {
  std::string rows;
  for (const MaskResult& result : models) {
    for (const auto& [roll_deg, overlap] : result.overlap) {
      rows += fmt::format("{:<36} {:>6.0f} {:>10.3f} {:>12.3f} {:>14.3f} {:>15.3f}\n", result.model.title(), roll_deg,
                          overlap.iou(), overlap.precision(), overlap.recall(), overlap.box_precision());
    }
  }
  if (rows.empty()) return rows;
  return fmt::format("\n{:<36} {:>6} {:>10} {:>12} {:>14} {:>15}\n", "pixels in boxes", "roll", "mask IoU", "precision",
                     "recall", "boxes' precision") +
         rows;
}

std::string lines_of(const InputReport& input, const std::string& partner) {
  std::string text = fmt::format("{} images", input.images);
  if (input.without_partner > 0) text += fmt::format(", {} {}", input.without_partner, partner);
  if (input.not_decoded > 0) text += fmt::format(", {} left out", input.not_decoded);
  text += '\n';
  for (std::size_t i = 0; i < std::min(input.problems.size(), kShownProblems); ++i)
    text += "  " + input.problems[i] + '\n';
  if (input.problems.size() > kShownProblems) {
    text += fmt::format("  and {} more (--Json lists all)\n", input.problems.size() - kShownProblems);
  }
  return text;
}

Json to_json(const LabelledResults& results) {
  Json document = {{"input", input_json(results.input)},
                   {"label_format", results.format},
                   {"wanted_recall", results.wanted_recall},
                   {"models", Json::array()}};
  for (const LabelledResult& result : results.models) {
    Json entry = model_json(result.model);
    entry["ap50"] = result.accuracy.ap50;
    entry["ap50_95"] = result.accuracy.ap50_95;
    if (result.agreement) entry["agreement"] = agreement_json(*result.agreement);
    for (const auto& [name, accuracy] : result.accuracy.classes) entry["classes"][name] = boxes_json(accuracy);
    for (const auto& [name, accuracy] : result.accuracy.groups) {
      entry["levels"][name] = group_json(accuracy, results.wanted_recall);
    }
    document["models"].push_back(entry);
  }
  return document;
}

Json to_json(const MaskResults& results) {
  Json document = {{"input", input_json(results.input)}, {"models", Json::array()}};
  for (const MaskResult& result : results.models) {
    Json entry = model_json(result.model);
    entry["as_seen"] = recall_json(result.as_seen);
    if (!result.overlap.empty()) entry["masks"] = overlap_json(result.overlap);
    document["models"].push_back(entry);
  }
  return document;
}

std::string to_table(const LabelledResults& results) {
  return model_rows(results) + threshold_rows(results) + agreement_rows(results);
}

std::string to_table(const MaskResults& results) {
  std::string text = fmt::format("{:<36} {:>6} {:>10} {:>12} {:>14} {:>9} {:>8} {:>8}\n", "model", "roll", "confidence",
                                 "pixel recall", "images complete", "people", "boxes", "beside");
  for (const MaskResult& result : results.models) {
    text += recall_rows(result.model.title(), result.as_seen);
  }
  return text +
         "images complete: every marked area (400 px or more) has half of its pixels in boxes; beside: boxes on "
         "nothing marked\n" +
         overlap_rows(results.models);
}

/// "0:180:15" -> 0, 15 .. 180; "90" -> 90.
RollRange parse_roll(const std::string& text) {
  RollRange roll;
  char rest = 0;
  const int numbers = std::sscanf(text.c_str(), "%lf:%lf:%lf%c", &roll.from_deg, &roll.to_deg, &roll.step_deg, &rest);
  if (numbers == 1) roll.to_deg = roll.from_deg;
  const bool one = numbers == 1 && text.find(':') == std::string::npos;
  if ((numbers != 3 && !one) || roll.to_deg < roll.from_deg || roll.step_deg < 1 || roll.from_deg < -360 ||
      roll.to_deg > 360) {
    throw CLI::ValidationError("--roll", "'" + text + "' is not FROM:TO:STEP in degrees (-360..360, step 1 or more)");
  }
  return roll;
}

/// Runs before the long work, so that a wrong path does not waste it.
void check_output(const EvalDetectorOptions& options) {
  try {
    if (!options.json.empty()) const io::AtomicFile begun(options.json, {.named_by = io::NamedBy::kOperator});
  } catch (const io::IoError& error) {
    throw service::ConfigError(std::string("--json ") + error.what());
  }
}

void print_results(const EvalDetectorOptions& options, const auto& results, const char* without_partner,
                   std::ostream& out, std::ostream& err) {
  err << lines_of(results.input, without_partner);
  out << to_table(results);
  if (options.json.empty()) return;
  try {
    io::write_file(options.json, service::json_text(to_json(results)) + "\n", {.named_by = io::NamedBy::kOperator});
  } catch (const io::IoError& error) {
    throw service::ConfigError(std::string("--json ") + error.what());
  }
}

void add_mask_options(CLI::App& command, EvalDetectorOptions& options) {
  command.add_option("--masks", options.masks, "Folder of masks named like the images, white = object: recall");
  command.add_flag("--dark-masks", options.dark_masks, "Masks: objects are black");
  command.add_option("--class", options.class_name, "Masks: the class that they show")->capture_default_str();
  command.add_option("--mask-model", options.mask_model,
                     "Masks: how well this network's agree inside the boxes (person-mask, or an ONNX file)");
  options.thresholds = {detector::DecodeConfig{}.confidence_threshold};
  command.add_option("--confidence", options.thresholds, "Masks: confidence thresholds")
      ->check(CLI::Range(0.001, 1.0))
      ->capture_default_str();
  command.add_option_function<std::string>(
      "--roll", [&options](const std::string& text) { options.roll = parse_roll(text); },
      "Masks: turn image and mask, degrees FROM:TO:STEP, e.g. 0:180:15");
}

}  // namespace

CLI::App* add_eval_detector_command(CLI::App& parent, EvalDetectorOptions& options) {
  CLI::App* command =
      parent.add_subcommand("detector", "Average precision, recall and time of detector models on labelled images");
  command->add_option("--images", options.images, "Folder of images")->required();
  CLI::Option* labels =
      command->add_option("--labels", options.labels, "Folder of labels named like the images: YOLO .txt, VOC .xml");
  command->add_option("--label-format", options.label_format, "auto, yolo or voc")
      ->check(CLI::IsMember({"auto", "yolo", "voc"}))
      ->capture_default_str();
  command->add_option("--names", options.names_file, "Class names, one per line (default: those of the model)");
  command->add_option("--model", options.models, "ONNX files, compared side by side (default: the usual model)");
  command->add_option("--engine", options.engines, std::string(msg::kEngineNames) + "; several: compared side by side")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--recall", options.wanted_recall, "Wanted recall of the high motion level")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  command->add_option("--step", options.step, "Every n-th image")->check(CLI::Range(1, 100000))->capture_default_str();
  command->add_option("--json", options.json, "Write all figures here");
  add_mask_options(*command, options);
  labels->excludes("--masks");
  return command;
}

int run_eval_detector(const EvalDetectorOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("rtd eval-detector", err, [&] {
    if (options.labels.empty() && options.masks.empty()) {
      throw service::ConfigError("add --labels DIR (average precision) or --masks DIR (recall)");
    }
    if (!options.mask_model.empty() && (options.masks.empty() || options.class_name != "person"))
      throw service::ConfigError("--mask-model needs --masks DIR that show people (--class person)");
    check_output(options);
    if (options.labels.empty()) {
      print_results(options, evaluate_masks(options, err), "without mask (left out)", out, err);
    } else {
      print_results(options, evaluate_labels(options, err), "without label file (no objects)", out, err);
    }
    return service::kOk;
  });
}

}  // namespace rtd::eval
