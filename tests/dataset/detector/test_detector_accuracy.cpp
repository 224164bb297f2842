// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <opencv2/imgcodecs.hpp>

#include "services/detector/core/coco_classes.hpp"
#include "services/detector/core/detector.hpp"
#include "services/detector/core/model_locator.hpp"

namespace rtd::detector {
namespace {

namespace fs = std::filesystem;

/// Confidence at which a person is found in every image of the target domain and little else is.
constexpr double kPersonConfidence = 0.4;

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

cv::Rect2f box_of(const vision::Detection& detection) {
  return {detection.x_px, detection.y_px, detection.width_px, detection.height_px};
}

float overlap(const cv::Rect2f& a, const cv::Rect2f& b) {
  const float intersection = (a & b).area();
  return intersection / (a.area() + b.area() - intersection);
}

class DetectorAccuracy : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const data = std::getenv("RTD_DATA_DIR");
    if (data == nullptr) GTEST_SKIP() << "RTD_DATA_DIR is not set";
    data_ = data;
    const ModelSearch model = find_model("", process_environment());
    if (!model) GTEST_SKIP() << model.message;
    config_.model_path = model.path;
    config_.decode.confidence_threshold = kPersonConfidence;
  }
  static std::vector<cv::Rect2f> people(Detector& detector, const cv::Mat& image) {
    std::vector<cv::Rect2f> boxes;
    for (const vision::Detection& detection : detector.detect(image))
      if (detection.class_name == "person") boxes.push_back(box_of(detection));
    return boxes;
  }
  /// Share of the dynamic pixels of every `step`-th frame that lie in a person's box.
  double dynamic_pixel_recall(const std::string& clip, std::size_t step) {
    Detector detector(config_);
    const std::vector<fs::path> images = files_in(data_ / clip / "rgb"), masks = files_in(data_ / clip / "mask");
    double covered = 0, dynamic = 0;
    for (std::size_t i = 0; i < std::min(images.size(), masks.size()); i += step) {
      cv::Mat mask = cv::imread(masks[i].string(), cv::IMREAD_GRAYSCALE) > 0;
      dynamic += cv::countNonZero(mask);
      for (const cv::Rect2f& box : people(detector, cv::imread(images[i].string()))) {
        const cv::Mat inside = mask(cv::Rect(box) & cv::Rect({0, 0}, mask.size()));
        covered += cv::countNonZero(inside);
        mask(cv::Rect(box) & cv::Rect({0, 0}, mask.size())).setTo(0);  // count overlapping boxes once
      }
    }
    return dynamic > 0 ? covered / dynamic : 0;
  }

  fs::path data_;
  DetectorConfig config_;
};

TEST_F(DetectorAccuracy, finds_a_person_in_every_still) {
  if (!fs::is_directory(data_ / "people_stills/rgb")) GTEST_SKIP() << "no people_stills in RTD_DATA_DIR";
  Detector detector(config_);
  for (const fs::path& path : files_in(data_ / "people_stills/rgb")) {
    EXPECT_FALSE(people(detector, cv::imread(path.string())).empty()) << path;
  }
}

TEST_F(DetectorAccuracy, covers_the_people_who_walk_through_the_clips) {
  for (const std::string clip : {"walk_xyz", "walk_rpy"}) {
    if (!fs::is_directory(data_ / clip / "mask")) GTEST_SKIP() << "no " << clip << " in RTD_DATA_DIR";
    const double recall = dynamic_pixel_recall(clip, 10);
    EXPECT_GE(recall, 0.97) << clip;  // measured: 0.995 and 0.990 over all frames
  }
}

struct Truth {
  cv::Rect2f box;
  bool taken = false;
};
struct Claim {
  float score;
  bool correct;
};

std::map<std::string, std::vector<Truth>> read_labels(const fs::path& path, cv::Size image) {
  std::map<std::string, std::vector<Truth>> truths;
  std::ifstream file(path);
  std::size_t class_index = 0;
  for (float x = 0, y = 0, w = 0, h = 0; file >> class_index >> x >> y >> w >> h;) {
    const auto width = static_cast<float>(image.width), height = static_cast<float>(image.height);
    const cv::Rect2f box((x - w / 2) * width, (y - h / 2) * height, w * width, h * height);
    truths[coco_class_names().at(class_index)].push_back({box});
  }
  return truths;
}

/// Area under the precision-recall curve, precision made monotonous (PASCAL VOC 2010 and COCO).
double average_precision(std::vector<Claim> claims, std::size_t truth_count) {
  std::stable_sort(claims.begin(), claims.end(), [](const Claim& a, const Claim& b) { return a.score > b.score; });
  std::vector<double> precision(claims.size());
  double correct = 0;
  for (std::size_t i = 0; i < claims.size(); ++i) {
    correct += claims[i].correct ? 1 : 0;
    precision[i] = correct / static_cast<double>(i + 1);
  }
  double area = 0, best_behind = 0;
  for (std::size_t i = claims.size(); i-- > 0;) {
    best_behind = std::max(best_behind, precision[i]);
    if (claims[i].correct) area += best_behind / static_cast<double>(truth_count);
  }
  return area;
}

TEST(AveragePrecision, is_as_computed_by_hand) {
  EXPECT_DOUBLE_EQ(average_precision({{0.9F, true}, {0.8F, true}}, 2), 1.0);
  EXPECT_DOUBLE_EQ(average_precision({{0.9F, true}, {0.8F, false}, {0.7F, true}}, 2), 0.5 + 0.5 * 2 / 3);
  EXPECT_DOUBLE_EQ(average_precision({{0.9F, false}, {0.8F, true}, {0.7F, true}}, 4), 0.25 * 2 / 3 * 2);
  EXPECT_DOUBLE_EQ(average_precision({}, 4), 0.0);
}

TEST_F(DetectorAccuracy, reaches_its_average_precision_on_coco) {
  const fs::path folder = data_ / "coco_val128";
  if (!fs::is_directory(folder / "images")) GTEST_SKIP() << "no coco_val128 in RTD_DATA_DIR";
  config_.decode.confidence_threshold = 0.01;
  config_.decode.objectness_threshold = 0.01;
  Detector detector(config_);
  std::map<std::string, std::vector<Claim>> claims;
  std::map<std::string, std::size_t> truth_count;
  for (const fs::path& path : files_in(folder / "images")) {
    const cv::Mat image = cv::imread(path.string());
    auto truths = read_labels(folder / "labels" / path.stem().concat(".txt"), image.size());
    for (const auto& [name, boxes] : truths) truth_count[name] += boxes.size();
    for (const vision::Detection& detection : detector.detect(image)) {
      std::vector<Truth>& candidates = truths[detection.class_name];
      const auto best = std::max_element(candidates.begin(), candidates.end(), [&](const Truth& a, const Truth& b) {
        return overlap(a.box, box_of(detection)) < overlap(b.box, box_of(detection));
      });
      const bool correct = best != candidates.end() && !best->taken && overlap(best->box, box_of(detection)) >= 0.5F;
      if (correct) best->taken = true;
      claims[detection.class_name].push_back({detection.score, correct});
    }
  }
  double sum = 0;
  for (const auto& [name, count] : truth_count) sum += average_precision(claims[name], count);
  const double map50 = sum / static_cast<double>(truth_count.size());
  std::cout << "mAP50 " << map50 << " over " << truth_count.size() << " classes, person "
            << average_precision(claims["person"], truth_count["person"]) << '\n';
  EXPECT_GE(map50, 0.50);  // measured: 0.522, person 0.671
  EXPECT_GE(average_precision(claims["person"], truth_count["person"]), 0.65);
}

}  // namespace
}  // namespace rtd::detector
