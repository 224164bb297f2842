// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// The real files with permissive licences, from RTD_MODEL_DIR.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "services/detector/core/detector.hpp"

namespace rtd::detector {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

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
  std::ifstream file(config_.model_path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const fs::path cut = fs::path(::testing::TempDir()) / "rtd_cut_off.onnx";
  config_.model_path = cut.string();
  for (std::size_t size = 1000; size + 8 < bytes.size(); size += bytes.size() / 7) {
    std::ofstream(cut, std::ios::binary) << bytes.substr(0, size);
    EXPECT_THAT([&] { Detector detector(config_); }, ThrowsMessage<ModelError>(HasSubstr(cut.string()))) << size;
  }
  fs::remove(cut);
}

}  // namespace
}  // namespace rtd::detector
