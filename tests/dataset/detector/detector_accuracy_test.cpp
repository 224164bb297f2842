// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>

#include "common/service/model_locator.hpp"
#include "services/detector/core/detector.hpp"
#include "services/detector/core/detector_config.hpp"
#include "services/detector/core/engine.hpp"
#include "services/evaluation/core/detection/average_precision.hpp"
#include "services/evaluation/core/detection/mask_recall.hpp"

namespace rtd::detector {
namespace {

namespace fs = std::filesystem;

/// Confidence at which a person is found in every image of the target domain and little else is.
constexpr double kPersonConfidence = 0.4;
/// Of boxes that are published, and AP that is the same to three digits.
constexpr double kPublishedConfidence = 0.25, kSameAp = 5e-4;

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

class DetectorQuality : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const data = std::getenv("RTD_DATA_DIR");
    if (data == nullptr) GTEST_SKIP() << "RTD_DATA_DIR is not set";
    data_ = data;
    const service::ModelSearch model = service::find_model("yolov5-lite", service::process_environment());
    if (!model) GTEST_SKIP() << model.message;
    config_.model_path = model.path;
    config_.engine = "cpu";
    config_.decode.confidence_threshold = kPersonConfidence;
  }
  static std::vector<vision::Detection> people(Detector& detector, const cv::Mat& image) {
    std::vector<vision::Detection> boxes = detector.detect(image);
    std::erase_if(boxes, [](const vision::Detection& box) { return box.class_name != "person"; });
    return boxes;
  }
  /// What of the dynamic pixels of every `step`-th frame lies in a person's box.
  eval::MaskRecall dynamic_pixel_recall(const std::string& clip, std::size_t step) {
    Detector detector(config_);
    const std::vector<fs::path> images = files_in(data_ / clip / "rgb"), masks = files_in(data_ / clip / "mask");
    eval::MaskRecall recall;
    for (std::size_t i = 0; i < std::min(images.size(), masks.size()); i += step) {
      const cv::Mat mask = cv::imread(masks[i].string(), cv::IMREAD_GRAYSCALE);
      recall = eval::measure_mask_recall(mask, people(detector, cv::imread(images[i].string())), recall);
    }
    return recall;
  }

  /// The images of coco_val128 with their labels and all boxes of each detector, down to the least score.
  std::vector<std::vector<eval::EvaluatedImage>> detect_on_coco(const std::vector<Detector*>& detectors) {
    const fs::path folder = data_ / "coco_val128";
    std::vector<std::vector<eval::EvaluatedImage>> evaluated(detectors.size());
    for (const fs::path& path : files_in(folder / "images")) {
      const cv::Mat image = cv::imread(path.string());
      std::ifstream file(folder / "labels" / path.stem().concat(".txt"));
      const eval::ImageLabels labels = eval::parse_yolo_labels(
          {path.stem(), {std::istreambuf_iterator<char>(file), {}}}, {image.cols, image.rows}, coco_class_names());
      EXPECT_TRUE(labels.problems.empty()) << labels.problems.front();
      for (std::size_t i = 0; i < detectors.size(); ++i)
        evaluated[i].push_back({labels.boxes, detectors[i]->detect(image)});
    }
    return evaluated;
  }
  static eval::AccuracyReport accuracy_of(const std::vector<eval::EvaluatedImage>& images) {
    return eval::evaluate_detector(images, [](const std::string&) { return ""; });
  }

  fs::path data_;
  DetectorConfig config_;
};

TEST_F(DetectorQuality, finds_a_person_in_every_still) {
  if (!fs::is_directory(data_ / "people_stills/rgb")) GTEST_SKIP() << "no people_stills in RTD_DATA_DIR";
  Detector detector(config_);
  for (const fs::path& path : files_in(data_ / "people_stills/rgb")) {
    EXPECT_FALSE(people(detector, cv::imread(path.string())).empty()) << path;
  }
}

TEST_F(DetectorQuality, covers_the_people_who_walk_through_the_clips) {
  for (const std::string clip : {"walk_xyz", "walk_rpy"}) {
    if (!fs::is_directory(data_ / clip / "mask")) GTEST_SKIP() << "no " << clip << " in RTD_DATA_DIR";
    const double recall = dynamic_pixel_recall(clip, 10).pixel_recall();
    EXPECT_GE(recall, 0.97) << clip;  // measured: 0.995 and 0.990 over all frames
  }
}

TEST_F(DetectorQuality, reaches_its_average_precision_on_coco) {
  if (!fs::is_directory(data_ / "coco_val128/images")) GTEST_SKIP() << "no coco_val128 in RTD_DATA_DIR";
  config_.decode.confidence_threshold = config_.decode.objectness_threshold = 0.001;
  Detector detector(config_);
  const eval::AccuracyReport report = accuracy_of(detect_on_coco({&detector}).front());
  std::cout << "AP50 " << report.ap50 << ", AP50:95 " << report.ap50_95 << " over " << report.classes.size()
            << " classes, person AP50 " << report.person.ap50() << '\n';
  EXPECT_GE(report.ap50, 0.50);  // measured: 0.523, 0.341, person 0.671
  EXPECT_GE(report.ap50_95, 0.32);
  EXPECT_GE(report.person.ap50(), 0.65);
}

/// A network with a permissive licence, and what it reaches at least.
struct Permissive {
  const char* name;
  double person_ap50, ap50;
};

class PermissiveQuality : public DetectorQuality, public ::testing::WithParamInterface<Permissive> {
 protected:
  void SetUp() override {
    const char* const data = std::getenv("RTD_DATA_DIR");
    data_ = data == nullptr ? "/nowhere" : data;
    if (!fs::is_directory(data_ / "coco_val128/images")) GTEST_SKIP() << "no coco_val128 in RTD_DATA_DIR";
    const service::ModelSearch model = service::find_model(GetParam().name, service::process_environment());
    if (!model) GTEST_SKIP() << model.message;
    config_.model_path = model.path;
    config_.engine = "cpu";
  }
};

INSTANTIATE_TEST_SUITE_P(Networks, PermissiveQuality,
                         ::testing::Values(Permissive{"yolox-nano", 0.64, 0.50}, Permissive{"nanodet-g", 0.63, 0.43}),
                         [](const auto& trial) { return std::string(trial.param.name).substr(0, 5); });

TEST_P(PermissiveQuality, reaches_its_average_precision_on_coco) {
  config_.decode.confidence_threshold = config_.decode.objectness_threshold = 0.001;
  Detector detector(config_);
  const eval::AccuracyReport report = accuracy_of(detect_on_coco({&detector}).front());
  std::cout << detector.family() << ": AP50 " << report.ap50 << ", person AP50 " << report.person.ap50() << '\n';
  EXPECT_GE(report.person.ap50(), GetParam().person_ap50);  // measured: YOLOX-nano 0.643, NanoDet-g 0.643
  EXPECT_GE(report.ap50, GetParam().ap50);                  // measured: YOLOX-nano 0.506, NanoDet-g 0.439
}

/// ONNX Runtime with each network.
class EngineQuality : public DetectorQuality, public ::testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    DetectorQuality::SetUp();
    if (IsSkipped()) return;
    if (!fs::is_directory(data_ / "coco_val128/images")) GTEST_SKIP() << "no coco_val128 in RTD_DATA_DIR";
    if (!knows_onnxruntime() || !fs::exists(ONNXRUNTIME_LIBRARY))
      GTEST_SKIP() << "needs ONNX Runtime: deploy/setup.sh --onnxruntime, then configure again";
    const service::ModelSearch model = service::find_model(GetParam(), service::process_environment());
    if (!model) GTEST_SKIP() << model.message;
    config_.model_path = model.path;
    config_.decode.confidence_threshold = config_.decode.objectness_threshold = 0.001;
  }
};

INSTANTIATE_TEST_SUITE_P(Onnxruntime, EngineQuality, ::testing::Values("v5lite-s-raw-480x640.onnx", "yolox_nano.onnx"),
                         [](const auto& trial) { return std::string(trial.param).substr(0, 5); });

TEST_P(EngineQuality, finds_on_coco_what_the_cpu_finds) {
  Detector cpu(config_);
  config_.engine = "onnxruntime:" ONNXRUNTIME_LIBRARY;
  Detector compared(config_);
  ASSERT_NE(compared.device(), cpu.device());
  const auto evaluated = detect_on_coco({&cpu, &compared});
  AgreementCount count;
  for (std::size_t i = 0; i < evaluated[0].size(); ++i)
    count.add(disagreement(evaluated[0][i].detections, evaluated[1][i].detections, kPublishedConfidence));
  EXPECT_EQ(count.agreeing, count.images) << count.first_difference;
  const eval::AccuracyReport expected = accuracy_of(evaluated[0]), actual = accuracy_of(evaluated[1]);
  std::cout << compared.device() << ": AP50 " << actual.ap50 << ", AP50:95 " << actual.ap50_95 << "; CPU "
            << expected.ap50 << ", " << expected.ap50_95 << '\n';
  EXPECT_NEAR(actual.ap50, expected.ap50, kSameAp);
  EXPECT_NEAR(actual.ap50_95, expected.ap50_95, kSameAp);
}

}  // namespace
}  // namespace rtd::detector
