// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/detector/eval_detector_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <ostream>

#include "common/io/atomic_file.hpp"
#include "common/msg/engine_names.hpp"
#include "common/service/json_text.hpp"
#include "services/evaluation/commands/guarded.hpp"
#include "services/evaluation/detector/detector_report.hpp"
#include "services/evaluation/detector/evaluate.hpp"

namespace rtd::eval {
namespace {

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

void print_results(const EvalDetectorOptions& options, const auto& results, std::ostream& out, std::ostream& err) {
  err << input_lines(results);
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
  command.add_flag("--derotate", options.derotate, "Masks: also detect on the image turned upright by the true roll");
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
      print_results(options, evaluate_masks(options, err), out, err);
    } else {
      print_results(options, evaluate_labels(options, err), out, err);
    }
    return service::kOk;
  });
}

}  // namespace rtd::eval
