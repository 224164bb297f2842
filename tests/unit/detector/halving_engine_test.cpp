// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <opencv2/core.hpp>

#include "services/detector/core/engine.hpp"

namespace rtd::detector {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

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
