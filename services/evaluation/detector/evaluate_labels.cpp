// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <opencv2/imgcodecs.hpp>

#include "common/service/progress.hpp"
#include "common/vision/motion_levels.hpp"
#include "services/evaluation/detector/evaluate.hpp"
#include "services/evaluation/detector/image_folder.hpp"
#include "services/evaluation/detector/label_folder.hpp"

namespace rtd::launcher {
namespace {

constexpr double kLeastScore = 0.001;  // the whole curve counts
constexpr std::size_t kTimedImages = 40;

std::string level_of(const std::string& class_name) {
  static const vision::MotionLevels levels;
  const auto level = levels.find(class_name);
  if (!level) return {};
  return *level == vision::MotionLevel::kHigh ? "high" : *level == vision::MotionLevel::kMedium ? "medium" : "low";
}

/// One image with what every model finds in it.
void evaluate_image(const cv::Mat& image, const std::filesystem::path& path, const LabelFolder& labels,
                    std::vector<ModelUnderTest>& models, std::vector<std::vector<detector::EvaluatedImage>>& evaluated,
                    InputReport& input) {
  if (!labels.has(path)) ++input.without_partner;
  for (std::size_t m = 0; m < models.size(); ++m) {
    detector::ImageLabels truth = labels.read(path, {image.cols, image.rows}, models[m].class_names());
    if (m == 0) input.problems.insert(input.problems.end(), truth.problems.begin(), truth.problems.end());
    evaluated[m].push_back({std::move(truth.boxes), models[m].detect(image)});
    if (input.images < kTimedImages) models[m].take_time(image);
  }
  ++input.images;
}

void require_objects(const EvalDetectorOptions& options, const InputReport& input,
                     const std::vector<detector::EvaluatedImage>& evaluated) {
  if (input.without_partner == input.images && input.images > 0) {
    throw EvalDetectorError("--labels " + options.labels + ": no file there is named like an image of --images " +
                            options.images + " (photo.jpg needs photo.txt or photo.xml)");
  }
  for (const detector::EvaluatedImage& image : evaluated)
    if (!image.truths.empty()) return;
  throw EvalDetectorError("--labels " + options.labels + ": not one object can be used" +
                          (input.problems.empty() ? "" : ", for example " + input.problems.front()));
}

}  // namespace

LabelledResults evaluate_labels(const EvalDetectorOptions& options, std::ostream& err) {
  const std::vector<std::filesystem::path> images = images_in(options.images, "--images", options.step);
  const LabelFolder labels(options.labels, options.label_format);
  std::vector<ModelUnderTest> models = load_models(options, kLeastScore);
  std::vector<std::vector<detector::EvaluatedImage>> evaluated(models.size());
  LabelledResults results{{}, labels.format(), options.wanted_recall, {}};
  service::Progress progress(err, "images", images.size());
  for (const std::filesystem::path& path : images) {
    const cv::Mat image = cv::imread(path.string());
    if (image.empty()) {
      ++results.input.not_decoded;
      results.input.problems.push_back(path.filename().string() + ": is no image, left out");
    } else {
      evaluate_image(image, path, labels, models, evaluated, results.input);
    }
    progress.advance();
  }
  require_objects(options, results.input, evaluated.front());
  for (std::size_t m = 0; m < models.size(); ++m) {
    results.models.push_back({models[m].facts(), detector::evaluate_detector(evaluated[m], level_of)});
  }
  return results;
}

}  // namespace rtd::launcher
