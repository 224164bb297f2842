// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <future>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>

#include "common/service/model_locator.hpp"
#include "services/detector/core/detector.hpp"
#include "services/detector/core/engine.hpp"
#include "services/detector/core/fast_sigmoid.hpp"
#include "services/detector/core/network_input.hpp"

namespace rtd::detector {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Letterbox, leaves_a_frame_of_the_inputs_size_alone) {
  const Letterbox letterbox = fit_letterbox({640, 480}, {640, 480});
  EXPECT_DOUBLE_EQ(letterbox.scale_x, 1.0);
  EXPECT_DOUBLE_EQ(letterbox.scale_y, 1.0);
  EXPECT_EQ(letterbox.pad_left_px, 0);
  EXPECT_EQ(letterbox.pad_top_px, 0);
}

TEST(Letterbox, centres_a_wide_frame_between_grey_bars) {
  const Letterbox letterbox = fit_letterbox({640, 320}, {320, 320});
  EXPECT_EQ(letterbox.width_px, 320);
  EXPECT_EQ(letterbox.height_px, 160);
  EXPECT_EQ(letterbox.pad_left_px, 0);
  EXPECT_EQ(letterbox.pad_top_px, 80);
  EXPECT_DOUBLE_EQ(letterbox.scale_x, 0.5);
}

TEST(Letterbox, never_shrinks_a_sliver_to_nothing) {
  const Letterbox letterbox = fit_letterbox({10000, 1}, {320, 320});
  EXPECT_EQ(letterbox.width_px, 320);
  EXPECT_EQ(letterbox.height_px, 1);
}

TEST(FillBlob, writes_rgb_planes_scaled_to_one) {
  cv::Mat image(2, 2, CV_8UC3, cv::Scalar(0, 51, 255));  // blue, green, red
  cv::Mat blob;
  fill_blob(image, fit_letterbox(image.size(), {2, 2}), {2, 2}, PixelFormat(), blob);
  ASSERT_EQ(blob.total(), 12U);
  const float* const values = blob.ptr<float>();
  EXPECT_FLOAT_EQ(values[0], 1.0F);
  EXPECT_FLOAT_EQ(values[4], 0.2F);
  EXPECT_FLOAT_EQ(values[8], 0.0F);
}

TEST(FillBlob, fills_the_bars_with_grey_and_the_middle_with_the_frame) {
  const cv::Mat image(2, 4, CV_8UC3, cv::Scalar::all(255));
  cv::Mat blob;
  fill_blob(image, fit_letterbox(image.size(), {4, 4}), {4, 4}, PixelFormat(), blob);
  const float* const red = blob.ptr<float>();
  EXPECT_FLOAT_EQ(red[0], 114.0F / 255.0F);
  EXPECT_FLOAT_EQ(red[4], 1.0F);
  EXPECT_FLOAT_EQ(red[11], 1.0F);
  EXPECT_FLOAT_EQ(red[12], 114.0F / 255.0F);
}

TEST(FillBlob, writes_the_format_that_the_network_wants) {
  const cv::Mat image(1, 2, CV_8UC3, cv::Scalar(10, 20, 30));  // blue, green, red
  const PixelFormat pixels{.rgb = false, .offset = {4, 10, 0}, .scale = {0.5F, 2, 1}};
  cv::Mat blob;
  fill_blob(image, fit_letterbox(image.size(), {2, 3}), {2, 3}, pixels, blob);  // grey above and below
  const float* const values = blob.ptr<float>();
  EXPECT_FLOAT_EQ(values[2], 3.0F);
  EXPECT_FLOAT_EQ(values[6 + 2], 20.0F);
  EXPECT_FLOAT_EQ(values[12 + 2], 30.0F);
  EXPECT_FLOAT_EQ(values[0], 55.0F);
  EXPECT_FLOAT_EQ(values[6], 208.0F);
  EXPECT_FLOAT_EQ(values[12 + 5], 114.0F);
}

TEST(FastSigmoid, is_the_sigmoid) {
  std::vector<float> x, y;
  for (float value = -100.0F; value <= 100.0F; value += 0.0137F) x.push_back(value);
  y.resize(x.size());
  sigmoid(x.data(), y.data(), x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double expected = 1.0 / (1.0 + std::exp(-static_cast<double>(x[i])));
    EXPECT_NEAR(y[i], expected, 1e-6 * expected + 1e-37) << x[i];
  }
}

TEST(FastSigmoid, networks_may_be_loaded_in_several_threads) {
  const auto load = [] {
    for (int i = 0; i < 1000; ++i) const FastSigmoidScope scope;
  };
  auto other = std::async(std::launch::async, load);
  EXPECT_NO_THROW(load());
  EXPECT_NO_THROW(other.get());
}

TEST(FastSigmoid, works_in_place_and_at_the_ends) {
  const float infinity = std::numeric_limits<float>::infinity();
  std::vector<float> values = {0.0F, infinity, -infinity, 1e30F, -1e30F};
  sigmoid(values.data(), values.data(), values.size());
  EXPECT_FLOAT_EQ(values[0], 0.5F);
  EXPECT_FLOAT_EQ(values[1], 1.0F);
  EXPECT_NEAR(values[2], 0.0F, 1e-30F);
  EXPECT_FLOAT_EQ(values[3], 1.0F);
  EXPECT_NEAR(values[4], 0.0F, 1e-30F);
}

TEST(Network, equals_opencv) {
  const service::ModelSearch model = service::find_model("v5lite-s-raw-480x640.onnx", service::process_environment());
  if (!model) GTEST_SKIP() << model.message;
  DetectorConfig config;
  config.engine = "cpu";
  config.model_path = model.path;
  Network network(config);
  cv::Mat blob(std::vector<int>{1, 3, network.input_size().height_px, network.input_size().width_px}, CV_32F);
  cv::RNG(5).fill(blob, cv::RNG::UNIFORM, 0.0, 1.0);

  const std::vector<RawOutput>& heads = network.infer(blob);

  cv::dnn::Net dense = cv::dnn::readNetFromONNX(model.path);
  dense.setInput(blob);
  std::vector<cv::Mat> outputs;
  dense.forward(outputs, dense.getUnconnectedOutLayersNames());
  ASSERT_EQ(heads.size(), outputs.size());
  for (std::size_t i = 0; i < heads.size(); ++i) {
    ASSERT_EQ(heads[i].of(0).size(), outputs[i].total());
    for (std::size_t k = 0; k < outputs[i].total(); ++k)
      ASSERT_NEAR(heads[i].values[k], outputs[i].ptr<float>()[k], 1e-3F) << i << ' ' << k;
  }
}

/// Gives back the first number of each image; its memory holds `room` images.
class SmallDevice final : public Engine {
 public:
  SmallDevice(int room, std::vector<int>& batches) : room_(room), batches_(batches) {}
  const std::string& device() const override { return name_; }
  std::size_t outputs() const override { return 2; }
  const std::vector<RawOutput>& infer(const cv::Mat& blob) override {
    if (blob.size[0] > room_) throw OutOfDeviceMemory("full");
    batches_.push_back(blob.size[0]);
    logits_.clear();
    for (int i = 0; i < blob.size[0]; ++i) logits_.push_back(*blob.ptr<float>(i));
    heads_ = {{logits_.data(), {blob.size[0], 1, 1, 1}}, {}};
    return heads_;
  }

 private:
  const int room_;
  std::vector<int>& batches_;
  const std::string name_ = "small";
  std::vector<float> logits_;
  std::vector<RawOutput> heads_;
};

cv::Mat numbered_images(int count) {
  cv::Mat blob(std::vector<int>{count, 3, 2, 2}, CV_32F, cv::Scalar(0));
  for (int i = 0; i < count; ++i) *blob.ptr<float>(i) = static_cast<float>(i);
  return blob;
}

TEST(HalvingEngine, computes_in_parts_what_its_device_cannot_hold) {
  std::vector<int> batches;
  const auto engine = halve_when_full(std::make_unique<SmallDevice>(3, batches));
  const std::vector<RawOutput>& heads = engine->infer(numbered_images(10));
  EXPECT_THAT(batches, ElementsAre(3, 3, 3, 1)) << "10 and 5 were too many";
  ASSERT_EQ(heads[0].images(), 10);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(heads[0].of(i).front(), i);
  EXPECT_EQ(heads[1].values, nullptr) << "an output that is no float tensor stays so";
  EXPECT_THAT(engine->device(), HasSubstr("small, at most 3 images at once because"));
  engine->infer(numbered_images(4));
  EXPECT_THAT(batches, ElementsAre(3, 3, 3, 1, 3, 1)) << "it is remembered";
}

TEST(HalvingEngine, changes_nothing_while_there_is_room) {
  std::vector<int> batches;
  const auto engine = halve_when_full(std::make_unique<SmallDevice>(16, batches));
  EXPECT_EQ(engine->infer(numbered_images(16))[0].images(), 16);
  EXPECT_THAT(batches, ElementsAre(16));
  EXPECT_EQ(engine->device(), "small");
}

TEST(HalvingEngine, one_image_that_does_not_fit_is_an_error) {
  std::vector<int> batches;
  const auto engine = halve_when_full(std::make_unique<SmallDevice>(0, batches));
  EXPECT_THROW(engine->infer(numbered_images(5)), OutOfDeviceMemory);
}

}  // namespace
}  // namespace rtd::detector
