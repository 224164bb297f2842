// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/engine.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/service/model_locator.hpp"
#include "services/detector/core/agreement.hpp"
#include "services/detector/core/engine_guard.hpp"
#include "services/detector/core/yolo_network.hpp"
#include "tests/support/detector/tiny_network.hpp"

namespace rtd::detector {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::ThrowsMessage;
using vision::Detection;

constexpr char kNoDevice[] = "needs an OpenCL device: apt-get install pocl-opencl-icd";

class EngineTest : public ::testing::Test {
 protected:
  EngineTest() {
    std::filesystem::create_directories(folder_);
    config_.model_path = (folder_ / "tiny.onnx").string();
    config_.class_names = {"person", "box"};
    config_.kernel_cache = (folder_ / "kernels").string();
    std::ofstream(config_.model_path, std::ios::binary) << test::tiny_network_onnx({});
  }
  ~EngineTest() override { std::filesystem::remove_all(folder_); }

  /// Largest difference of the logits that decoding looks at, for a blob of noise.
  static double difference(const DetectorConfig& config) {
    DetectorConfig other = config;
    other.engine = "opencl";
    YoloNetwork cpu(config), opencl(other);
    EXPECT_THAT(opencl.device(), HasSubstr("OpenCL"));
    cv::Mat blob(std::vector<int>{1, 3, cpu.input().height_px, cpu.input().width_px}, CV_32F);
    cv::RNG(5).fill(blob, cv::RNG::UNIFORM, 0.0, 1.0);
    const std::vector<HeadLogits>&a = cpu.infer(blob), &b = opencl.infer(blob);
    const std::size_t planes = 5 + cpu.config().class_names.size();
    double largest = 0;
    for (std::size_t head = 0; head < a.size(); ++head) {
      const auto cells = static_cast<std::size_t>(a[head].rows) * static_cast<std::size_t>(a[head].cols);
      for (std::size_t anchor = 0; anchor < 3; ++anchor) {
        const std::size_t objectness = (anchor * planes + 4) * cells;
        for (std::size_t i = objectness; i < objectness + cells; ++i)
          largest = std::max(largest, std::abs(double{a[head].logits[i]} - b[head].logits[i]));
      }
    }
    return largest;
  }

  std::filesystem::path folder_ = std::filesystem::path(::testing::TempDir()) / "rtd_engine_test";
  DetectorConfig config_;
};

TEST_F(EngineTest, names_are_read_and_wrong_ones_refused) {
  EXPECT_EQ(parse_engine("auto").kind, EngineChoice::Kind::kAuto);
  EXPECT_EQ(parse_engine("opencl:H200").device, "H200");
  EXPECT_THAT([] { parse_engine("cuda"); },
              ThrowsMessage<EngineError>(HasSubstr("'cuda' is not an engine: use auto, cpu, opencl or opencl:DEVICE")));
}

TEST_F(EngineTest, a_device_that_is_not_there_is_an_error_that_says_which_are) {
  config_.engine = "opencl:no such device";
  const std::string known = opencl_devices().empty() ? "install the OpenCL driver" : "there are: ";
  EXPECT_THAT([&] { Detector detector(config_); }, ThrowsMessage<EngineError>(HasSubstr(known)));
}

TEST_F(EngineTest, the_guard_goes_on_with_the_cpu) {
  config_.engine = "opencl:no such device";
  EngineGuard guard(config_, true);
  EXPECT_THAT(guard.fallback(), HasSubstr("no such device"));
  EXPECT_EQ(guard.detector().device(), "CPU (OpenCV DNN)");
  cv::Mat image = cv::Mat::zeros(64, 64, CV_8UC3);
  image(cv::Rect(40, 24, 8, 8)).setTo(cv::Scalar::all(255));
  EXPECT_THAT(guard.detect_upright(image, 0), Not(IsEmpty()));
  config_.engine = "gpu";
  EXPECT_THROW(EngineGuard(config_, false), EngineError) << "a wrong name is the user's";
}

TEST_F(EngineTest, auto_takes_the_cpu_where_there_is_no_gpu) {
  for (const std::string& device : opencl_devices()) {
    if (device.ends_with("(GPU)")) GTEST_SKIP() << "this host has a GPU";
  }
  config_.engine = "auto";
  const EngineGuard guard(config_, true);
  EXPECT_EQ(guard.detector().device(), "CPU (OpenCV DNN)");
  EXPECT_THAT(guard.fallback(), IsEmpty());
}

TEST_F(EngineTest, opencl_computes_what_the_cpu_computes) {
  if (opencl_devices().empty()) GTEST_SKIP() << kNoDevice;
  EXPECT_LT(difference(config_), 1e-4);
}

TEST_F(EngineTest, opencl_computes_the_real_network) {
  const service::ModelSearch model = service::find_model("v5lite-e-raw-320x320.onnx", service::process_environment());
  if (!model) GTEST_SKIP() << model.message;
  if (opencl_devices().empty()) GTEST_SKIP() << kNoDevice;
  DetectorConfig config;
  config.model_path = model.path;
  EXPECT_LT(difference(config), 1e-4);
}

TEST_F(EngineTest, the_guard_verifies_ten_images) {
  if (opencl_devices().empty()) GTEST_SKIP() << kNoDevice;
  config_.engine = "opencl";
  EngineGuard guard(config_, true);
  cv::Mat image = cv::Mat::zeros(64, 64, CV_8UC3);
  image(cv::Rect(40, 24, 8, 8)).setTo(cv::Scalar::all(255));
  for (int i = 0; i < 12; ++i) EXPECT_THAT(guard.detect_upright(image, 0), Not(IsEmpty()));
  EXPECT_EQ(guard.verified(), EngineGuard::kVerifiedImages);
  EXPECT_THAT(guard.fallback(), IsEmpty());
}

TEST(Disagreement, is_counted_by_image) {
  AgreementCount count;
  for (const char* difference : {"", "it finds a dog", "it finds a cat"}) count.add(difference);
  EXPECT_EQ(count.images, 3U);
  EXPECT_EQ(count.agreeing, 1U);
  EXPECT_EQ(count.first_difference, "it finds a dog");
}

TEST(Disagreement, is_found_in_place_score_class_and_number) {
  const std::vector<Detection> boxes = {{"person", 0.8F, 10, 20, 30, 40}, {"chair", 0.5F, 100, 20, 30, 40}};
  const auto changed = [&](auto&& change) {
    std::vector<Detection> other = boxes;
    change(other);
    return disagreement(boxes, other, 0.25);
  };
  EXPECT_EQ(disagreement(boxes, boxes, 0.25), "");
  EXPECT_EQ(changed([](auto& other) { other[0].x_px += 0.4F, other[1].score += 0.0005F; }), "");
  EXPECT_THAT(changed([](auto& other) { other[0].width_px += 0.6F; }), HasSubstr("does not find person"));
  EXPECT_THAT(changed([](auto& other) { other[1].score -= 0.002F; }), HasSubstr("does not find chair"));
  EXPECT_THAT(changed([](auto& other) { other[1].class_name = "sofa"; }), Not(IsEmpty()));
  EXPECT_THAT(changed([](auto& other) { other.push_back({"dog", 0.3F, 1, 2, 3, 4}); }), HasSubstr("finds dog"));
  EXPECT_EQ(changed([](auto& other) { other.push_back({"dog", 0.2505F, 1, 2, 3, 4}); }), "") << "at the threshold";
}

}  // namespace
}  // namespace rtd::detector
