// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/engine.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <span>
#include <string>

#include "common/msg/engine_names.hpp"
#include "common/service/model_locator.hpp"
#include "services/detector/core/detector.hpp"
#include "tests/support/detector/tiny_network.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::detector {
namespace {

using namespace ::testing;
using vision::Detection;

/// With the library that the tests were built for.
std::string full_name(const std::string& engine) {
  return engine == "onnxruntime" ? engine + ":" ONNXRUNTIME_LIBRARY : engine;
}

/// Why an engine cannot be tested here; empty when it can.
std::string absent(const std::string& engine) {
  if (engine == "onnxruntime" && (!knows_onnxruntime() || !std::filesystem::exists(ONNXRUNTIME_LIBRARY)))
    return "needs ONNX Runtime: deploy/setup.sh --onnxruntime, then configure again";
  return {};
}

class EngineTest : public ::testing::Test {
 protected:
  EngineTest() {
    config_.model_path = folder_.write("tiny.onnx", test::tiny_network_onnx({}));
    config_.class_names = {"person", "box"};
    config_.engine = "cpu";
  }

  /// Largest difference of the logits that decoding looks at, for a blob of noise.
  static double difference(const DetectorConfig& config, const std::string& engine) {
    DetectorConfig other = config;
    other.engine = full_name(engine);
    Network cpu(config), compared(other);
    EXPECT_THAT(compared.device(), HasSubstr("ONNX Runtime 1."));
    cv::Mat blob(std::vector<int>{1, 3, cpu.input_size().height_px, cpu.input_size().width_px}, CV_32F);
    cv::RNG(5).fill(blob, cv::RNG::UNIFORM, 0.0, 1.0);
    std::vector<RawOutput> a = cpu.infer(blob), b = compared.infer(blob);
    for (auto* heads : {&a, &b}) std::ranges::sort(*heads, {}, &RawOutput::shape);  // each has its own order
    const std::size_t planes = 5 + cpu.config().class_names.size();
    double largest = 0;
    for (std::size_t head = 0; head < a.size(); ++head) {
      const auto cells = static_cast<std::size_t>(a[head].shape[2]) * static_cast<std::size_t>(a[head].shape[3]);
      for (std::size_t anchor = 0; anchor < 3; ++anchor) {
        const std::size_t objectness = (anchor * planes + 4) * cells;
        for (std::size_t i = objectness; i < objectness + cells; ++i)
          largest = std::max(largest, std::abs(double{a[head].values[i]} - b[head].values[i]));
      }
    }
    return largest;
  }

  const rtd::test::TemporaryFolder folder_;
  DetectorConfig config_;
};

TEST_F(EngineTest, names_are_read_and_wrong_ones_refused) {
  EXPECT_EQ(parse_engine("auto").kind, EngineChoice::Kind::kAuto);
  EXPECT_EQ(parse_engine("onnxruntime:/opt/a@b/libonnxruntime.so").library, "/opt/a@b/libonnxruntime.so");
  EXPECT_EQ(parse_engine("onnxruntime:/opt/libonnxruntime.so").device, "cpu");
  EXPECT_EQ(parse_engine("onnxruntime:/opt/libonnxruntime.so@cuda:1").library, "/opt/libonnxruntime.so");
  EXPECT_EQ(parse_engine("onnxruntime:/opt/libonnxruntime.so@cuda:1").device, "cuda:1");
  for (const char* without : {"onnxruntime", "onnxruntime:", "onnxruntime:@cuda"})
    EXPECT_THAT([&] { parse_engine(without); }, ThrowsMessage<EngineError>(HasSubstr("needs the path of its library")));
  EXPECT_THAT([] { parse_engine("cuda"); },
              ThrowsMessage<EngineError>(HasSubstr("'cuda' is not an engine: use cpu, onnxruntime:LIBRARY")));
}

/// The names in a list such as "cpu, onnxruntime:LIBRARY[@DEVICE] or auto (...)", each with all its parts.
std::set<std::string> listed(const std::string& list) {
  const std::string names = std::regex_replace(list, std::regex(R"( \(.*\)|[\[\]])"), "");
  const std::regex separator(", | or ");
  return {std::sregex_token_iterator(names.begin(), names.end(), separator, -1), std::sregex_token_iterator()};
}

TEST_F(EngineTest, the_names_in_help_texts_are_those_that_are_read) {
  std::set<EngineChoice::Kind> kinds;
  for (const std::string& name : listed(msg::kEngineNames)) kinds.insert(parse_engine(name).kind);
  using Kind = EngineChoice::Kind;
  EXPECT_THAT(kinds, UnorderedElementsAre(Kind::kAuto, Kind::kCpu, Kind::kOnnxRuntime));
  EXPECT_THAT([] { parse_engine("torch"); }, ThrowsMessage<EngineError>(HasSubstr(msg::kEngineNames)));
}

TEST_F(EngineTest, an_onnxruntime_library_that_does_not_fit_is_refused) {
  const auto refusal = [this](const std::string& library) -> std::string {
    config_.engine = "onnxruntime:" + library;
    const EngineGuard guard(config_);
    EXPECT_EQ(guard.detector().device(), "CPU (OpenCV DNN)");
    return guard.fallback();
  };
  if (!knows_onnxruntime()) {
    EXPECT_THAT(refusal("/nowhere.so"), HasSubstr("configure with -DRTD_ONNXRUNTIME_ROOT=DIR"));
    return;
  }
  EXPECT_THAT(refusal("/nowhere.so"), HasSubstr("cannot be loaded: /nowhere.so"));
  EXPECT_THAT(refusal("libdl.so.2"), HasSubstr("is not ONNX Runtime"));
  EXPECT_THAT(refusal(OLD_ONNXRUNTIME), HasSubstr("is ONNX Runtime 1.2.0: version 1.11 or later is needed"));
}

TEST_F(EngineTest, onnxruntime_names_a_device_that_is_not_there) {
  if (const std::string why = absent("onnxruntime"); !why.empty()) GTEST_SKIP() << why;
  config_.engine = full_name("onnxruntime") + "@tpu";
  EXPECT_THAT([&] { Detector detector(config_); }, ThrowsMessage<EngineError>(HasSubstr("use @cpu, @cuda or @cuda:N")));
  config_.engine = full_name("onnxruntime") + "@cuda:7";
  EXPECT_THAT([&] { Detector detector(config_); }, ThrowsMessage<EngineError>(HasSubstr("cannot use cuda:7: ")));
}

TEST_F(EngineTest, onnxruntime_says_why_it_does_not_take_a_network) {
  if (const std::string why = absent("onnxruntime"); !why.empty()) GTEST_SKIP() << why;
  std::string onnx = test::tiny_network_onnx({});
  for (std::size_t at = onnx.find("Conv"); at != std::string::npos; at = onnx.find("Conv", at))
    onnx.replace(at, 4, "Cunv");
  std::ofstream(config_.model_path, std::ios::binary) << onnx;
  config_.engine = full_name("onnxruntime");
  EXPECT_THAT([&] { Detector detector(config_); }, ThrowsMessage<EngineError>(HasSubstr("cannot load this network")));
}

/// In a process of its own: what the library writes comes with the first network alone.
TEST_F(EngineTest, onnxruntime_opens_a_network_without_a_word) {
  if (const std::string why = absent("onnxruntime"); !why.empty()) GTEST_SKIP() << why;
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  config_.engine = full_name("onnxruntime");
  EXPECT_EXIT(
      {
        const Network network(config_);
        std::exit(0);
      },
      ::testing::ExitedWithCode(0), IsEmpty());
}

TEST_F(EngineTest, the_guard_continues_with_the_cpu) {
  config_.engine = "onnxruntime:/nowhere.so";
  EngineGuard guard(config_);
  EXPECT_THAT(guard.fallback(), HasSubstr("ONNX Runtime"));
  EXPECT_EQ(guard.detector().device(), "CPU (OpenCV DNN)");
  cv::Mat image = cv::Mat::zeros(64, 64, CV_8UC3);
  image(cv::Rect(40, 24, 8, 8)).setTo(cv::Scalar::all(255));
  EXPECT_THAT(guard.detect(image), Not(IsEmpty()));
  config_.engine = "gpu";
  EXPECT_THROW(EngineGuard{config_}, EngineError) << "a wrong name is the user's";
}

TEST_F(EngineTest, auto_takes_the_cpu_where_there_is_no_onnxruntime) {
  config_.engine = "auto";
  const EngineGuard guard(config_);
  EXPECT_EQ(guard.detector().device(), "CPU (OpenCV DNN)");
  EXPECT_THAT(guard.fallback(), IsEmpty());
}

TEST_F(EngineTest, auto_takes_onnxruntime_first) {
  if (const std::string why = absent("onnxruntime"); !why.empty()) GTEST_SKIP() << why;
  config_.engine = "auto";
  config_.onnxruntime = ONNXRUNTIME_LIBRARY;
  const EngineGuard guard(config_);
  EXPECT_THAT(guard.detector().device(), HasSubstr("CPU (ONNX Runtime 1."));
  EXPECT_THAT(guard.fallback(), IsEmpty());
}

TEST_F(EngineTest, auto_says_why_it_does_not_take_the_onnxruntime_that_is_there) {
  if (!knows_onnxruntime()) GTEST_SKIP() << "built without ONNX Runtime";
  config_.engine = "auto";
  config_.onnxruntime = "libdl.so.2";
  const Detector detector(config_);
  EXPECT_THAT(detector.device(), HasSubstr("CPU (OpenCV DNN), because libdl.so.2 is not ONNX Runtime"));
}

TEST_F(EngineTest, auto_names_the_file_of_a_network_that_no_engine_takes) {
  const std::string whole = test::tiny_network_onnx({});
  std::ofstream(config_.model_path, std::ios::binary) << whole.substr(0, whole.size() / 2);
  config_.engine = "auto";
  config_.onnxruntime = ONNXRUNTIME_LIBRARY;
  EXPECT_THAT([&] { Detector detector(config_); }, ThrowsMessage<ModelError>(HasSubstr(config_.model_path)));
}

class OnnxruntimeTest : public EngineTest {
 protected:
  void SetUp() override {
    if (const std::string why = absent("onnxruntime"); !why.empty()) GTEST_SKIP() << why;
  }
};

TEST_F(OnnxruntimeTest, computes_what_the_cpu_computes) {
  EXPECT_LT(difference(config_, "onnxruntime"), 1e-4);
}

TEST_F(OnnxruntimeTest, computes_the_real_networks) {
  for (const std::string name : {"v5lite-e-raw-320x320.onnx", "v5lite-s-raw-480x640.onnx"}) {
    const service::ModelSearch model = service::find_model(name, service::process_environment());
    if (!model) GTEST_SKIP() << model.message;
    DetectorConfig config;
    config.engine = "cpu";
    config.model_path = model.path;
    EXPECT_LT(difference(config, "onnxruntime"), 1e-4) << name;
  }
}

TEST_F(OnnxruntimeTest, batches_hold_what_single_images_hold) {
  std::ofstream(config_.model_path, std::ios::binary) << test::tiny_network_onnx({.free_batch = true});
  config_.engine = full_name("onnxruntime");
  Detector detector(config_);
  std::vector<cv::Mat> images;
  std::vector<std::vector<Detection>> alone;
  for (int i = 0; i < 16; ++i) {
    images.push_back(cv::Mat::zeros(64, 64, CV_8UC3));
    images.back()(cv::Rect(8 * (i % 4), 8 * (i / 4), 8, 8)).setTo(cv::Scalar::all(255));
    alone.push_back(detector.detect(images.back()));
    EXPECT_THAT(alone.back(), Not(IsEmpty()));
  }
  for (std::size_t size = images.size(); size > 0; --size) {
    const auto together = detector.detect_batch(std::span(images).first(size));
    for (std::size_t i = 0; i < size; ++i)
      EXPECT_EQ(disagreement(alone[i], together[i], 0.25), "") << i << " of " << size;
  }
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
  EXPECT_EQ(changed([](auto& other) {
              other[0].x_px += 0.4F;
              other[1].score += 0.0005F;
            }),
            "");
  EXPECT_THAT(changed([](auto& other) { other[0].width_px += 0.6F; }), HasSubstr("does not find person"));
  EXPECT_THAT(changed([](auto& other) { other[1].score -= 0.002F; }), HasSubstr("does not find chair"));
  EXPECT_THAT(changed([](auto& other) { other[1].class_name = "sofa"; }), Not(IsEmpty()));
  EXPECT_THAT(changed([](auto& other) { other.push_back({"dog", 0.3F, 1, 2, 3, 4}); }), HasSubstr("finds dog"));
  EXPECT_EQ(changed([](auto& other) { other.push_back({"dog", 0.2505F, 1, 2, 3, 4}); }), "") << "at the threshold";
}

}  // namespace
}  // namespace rtd::detector
