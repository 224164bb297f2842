// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/detector.hpp"

#include <gmock/gmock.h>

#include <vector>

#include "services/detector/core/engine.hpp"
#include "tests/support/detector/tiny_network.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::detector {
namespace {

using namespace ::testing;

class EngineGuardTest : public ::testing::Test {
 protected:
  DetectorConfig config(const test::TinyNetwork& network) const {
    DetectorConfig config;
    config.model_path = folder_.write("tiny.onnx", test::tiny_network_onnx(network));
    config.class_names = {"person", "box"};
    return config;
  }
  /// Two images of different sizes; only the second one has something to find.
  static void expect_both_answered(EngineGuard& detector) {
    std::vector<cv::Mat> images = {cv::Mat::zeros(64, 64, CV_8UC3), cv::Mat::zeros(128, 128, CV_8UC3)};
    images[1](cv::Rect(80, 48, 16, 16)).setTo(cv::Scalar::all(255));
    const auto found = detector.detect_batch(images);
    ASSERT_THAT(found, SizeIs(2));
    EXPECT_THAT(found[0], IsEmpty());
    EXPECT_THAT(found[1], SizeIs(1));
  }

  const rtd::test::TemporaryFolder folder_;
};

TEST_F(EngineGuardTest, computes_images_of_different_sizes_at_once) {
  EngineGuard detector(config({.free_batch = true}), 4);
  EXPECT_EQ(detector.no_batch(), "");
  EXPECT_EQ(detector.device(), "CPU (OpenCV DNN)");
  expect_both_answered(detector);
}

TEST_F(EngineGuardTest, computes_one_by_one_with_a_network_of_one_image) {
  EngineGuard detector(config({}), 4);
  EXPECT_THAT(detector.no_batch(), HasSubstr("--free-batch"));
  EXPECT_THAT(detector.device(), HasSubstr("one image at a time"));
  expect_both_answered(detector);
}

TEST_F(EngineGuardTest, continues_on_the_cpu_without_the_engine_asked_for) {
  DetectorConfig without = config({.free_batch = true});
  without.engine = "onnxruntime:/nowhere.so";
  EngineGuard detector(without, 4);
  EXPECT_THAT(detector.fallback(), Not(IsEmpty()));
  EXPECT_THAT(detector.device(), HasSubstr("CPU (OpenCV DNN) in place of the engine asked for: "));
  expect_both_answered(detector);
  without.engine = "abacus";
  EXPECT_THROW(EngineGuard(without, 4), EngineError);
}

}  // namespace
}  // namespace rtd::detector
