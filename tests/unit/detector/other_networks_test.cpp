// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Networks whose weights are wrong: whatever they say, the answer is a short list of boxes inside the image.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "services/detector/core/detector.hpp"
#include "tests/support/detector/tiny_network.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::detector {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

class BrokenNetwork : public ::testing::Test {
 protected:
  /// A network of 640 x 480 with 18,900 cells, each weight replaced.
  Detector detector(const std::function<float(float)>& spoil) {
    DetectorConfig config;
    config.model_path =
        folder_.write("broken.onnx", test::tiny_network_onnx({.width_px = 640, .height_px = 480, .spoil = spoil}));
    config.class_names = {"person", "box"};
    config.decode.confidence_threshold = config.decode.objectness_threshold = 0.01;
    return Detector(config);
  }
  static void expect_sane(const std::vector<vision::Detection>& found) {
    EXPECT_LE(found.size(), 100U);
    for (const vision::Detection& box : found) {
      EXPECT_TRUE(box.score > 0 && box.score <= 1) << box.score;
      EXPECT_TRUE(box.x_px >= 0 && box.y_px >= 0 && box.width_px > 0 && box.height_px > 0);
      EXPECT_TRUE(box.x_px + box.width_px <= 640.01F && box.y_px + box.height_px <= 480.01F);
    }
  }
  static cv::Mat noise() {
    cv::Mat image(480, 640, CV_8UC3);
    cv::RNG random(5);
    random.fill(image, cv::RNG::UNIFORM, 0, 255);
    return image;
  }

 private:
  const rtd::test::TemporaryFolder folder_;
};

TEST_F(BrokenNetwork, of_nothing_but_nan_finds_nothing) {
  Detector network = detector([](float) { return kNan; });
  EXPECT_TRUE(network.detect(noise()).empty());
}

TEST_F(BrokenNetwork, that_sees_something_in_every_cell_gives_the_hundred_best) {
  Detector network = detector([](float) { return 0.1F; });
  const std::vector<vision::Detection> found = network.detect(noise());
  EXPECT_EQ(found.size(), 100U);
  expect_sane(found);
}

TEST_F(BrokenNetwork, of_random_weights_gives_boxes_inside_the_image) {
  for (const float size : {0.1F, 3.0F, 1e4F, 1e30F}) {
    std::mt19937 random(11);
    std::normal_distribution<float> normal(0, size);
    Detector network = detector([&](float) { return normal(random); });
    expect_sane(network.detect(noise()));
  }
}

TEST_F(BrokenNetwork, with_some_weights_lost_gives_boxes_inside_the_image) {
  for (const float lost : {kNan, kInfinity, -kInfinity}) {
    std::mt19937 random(13);
    Detector network = detector([&](float weight) { return random() % 50 == 0 ? lost : weight + 0.02F; });
    expect_sane(network.detect(noise()));
  }
}

// The real files with permissive licences, from RTD_MODEL_DIR.

namespace fs = std::filesystem;

/// A file, and what the program says of it.
struct Known {
  const char* file;
  const char* family;
};

class PermissiveModel : public ::testing::TestWithParam<Known> {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("RTD_MODEL_DIR");
    if (folder == nullptr) GTEST_SKIP() << "RTD_MODEL_DIR is not set";
    for (const fs::path& place : {fs::path(folder), fs::path(folder) / "permissive"})
      if (fs::is_regular_file(place / GetParam().file)) config_.model_path = (place / GetParam().file).string();
    if (config_.model_path.empty()) GTEST_SKIP() << "RTD_MODEL_DIR has no " << GetParam().file;
  }
  DetectorConfig config_;
};

INSTANTIATE_TEST_SUITE_P(Files, PermissiveModel,
                         ::testing::Values(Known{"yolox_nano.onnx", "YOLOX"}, Known{"nanodet_g.onnx", "NanoDet"}),
                         [](const auto& known) { return std::string(known.param.family); });

TEST_P(PermissiveModel, is_recognised_by_its_outputs) {
  const Detector detector(config_);
  EXPECT_EQ(detector.family(), GetParam().family);
  EXPECT_EQ(detector.input_size().width_px, 416);
  EXPECT_EQ(detector.input_size().height_px, 416);
}

TEST_P(PermissiveModel, finds_the_people_of_a_photograph) {
  const char* const data = std::getenv("RTD_DATA_DIR");
  const fs::path path = fs::path(data == nullptr ? "/nowhere" : data) / "people_stills/rgb/img2.jpg";
  const cv::Mat image = cv::imread(path.string());
  if (image.empty()) GTEST_SKIP() << "no " << path << " (RTD_DATA_DIR)";
  Detector detector(config_);
  int people = 0;
  for (const vision::Detection& box : detector.detect(image)) people += box.class_name == "person" ? 1 : 0;
  EXPECT_GE(people, 1);
}

TEST_P(PermissiveModel, with_other_class_names_is_refused_with_what_fits) {
  config_.class_names = {"person", "box"};
  EXPECT_THAT([&] { Detector detector(config_); },
              ThrowsMessage<ModelError>(AllOf(HasSubstr(config_.model_path), HasSubstr("80 classes"))));
}

TEST_P(PermissiveModel, cut_off_anywhere_is_refused_by_its_name) {
  const rtd::test::TemporaryFolder folder;
  const std::string bytes = rtd::test::read_text(config_.model_path);
  for (std::size_t size = 1000; size + 8 < bytes.size(); size += bytes.size() / 7) {
    config_.model_path = folder.write("cut_off.onnx", bytes.substr(0, size));
    EXPECT_THAT([&] { Detector detector(config_); }, ThrowsMessage<ModelError>(HasSubstr(config_.model_path))) << size;
  }
}

}  // namespace
}  // namespace rtd::detector
