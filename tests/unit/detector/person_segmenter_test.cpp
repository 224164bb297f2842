// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/person_segmenter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>
#include <utility>

#include "services/detector/core/detector_config.hpp"
#include "tests/support/detector/mask_network.hpp"
#include "tests/support/detector/tiny_network.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::detector {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int kInputPx = 64;

/// Takes what is red for a person: the red channel of the input is the probability.
class RednessEngine final : public Engine {
 public:
  explicit RednessEngine(int* runs) : runs_(runs) {}
  const std::string& device() const override { return device_; }
  std::size_t outputs() const override { return 1; }
  const std::vector<RawOutput>& infer(const cv::Mat& blob) override {
    ++*runs_;
    values_.assign(blob.ptr<float>(), blob.ptr<float>() + kInputPx * kInputPx);
    outputs_ = {{values_.data(), {1, 1, kInputPx, kInputPx}}};
    return outputs_;
  }

 private:
  int* const runs_;
  const std::string device_ = "redness";
  std::vector<float> values_;
  std::vector<RawOutput> outputs_;
};

vision::Detection person(const cv::Rect& box, const char* name = "person") {
  return {name, 0.9F, float(box.x), float(box.y), float(box.width), float(box.height)};
}

/// An image of 320 x 240 whose places have these probabilities.
cv::Mat image_of(const std::vector<std::pair<cv::Rect, double>>& people) {
  cv::Mat image(240, 320, CV_8UC3, cv::Scalar::all(0));
  for (const auto& [box, probability] : people) image(box).setTo(cv::Scalar(0, 0, 255 * probability));
  return image;
}

class PersonSegmenterTest : public ::testing::Test {
 protected:
  PersonSegmenter make(int masks_per_frame = 4) {
    MaskConfig config;
    config.masks_per_frame = masks_per_frame;
    PersonSegmenter segmenter(config, std::make_unique<RednessEngine>(&runs), {kInputPx, kInputPx});
    runs = 0;
    return segmenter;
  }
  int runs = 0;
};

/// Places with this label.
int area_of(const vision::PersonMasks& masks, int label) {
  return static_cast<int>(std::ranges::count(masks.labels, label));
}

TEST_F(PersonSegmenterTest, labels_the_places_of_the_person_and_no_others) {
  const cv::Rect body(120, 80, 40, 120);
  const vision::PersonMasks masks =
      make().segment(image_of({{body, 1}}), {person({0, 0, 50, 50}, "chair"), person({100, 70, 80, 140})}, 4);
  EXPECT_EQ(masks.columns, 80);
  EXPECT_EQ(masks.rows, 60);
  for (int row = 0; row < masks.rows; ++row) {
    for (int column = 0; column < masks.columns; ++column) {
      const cv::Point centre(column * vision::kMaskStepPx + 2, row * vision::kMaskStepPx + 2);
      EXPECT_EQ(masks.at(column, row), body.contains(centre) ? 2 : 0) << centre;
    }
  }
}

TEST_F(PersonSegmenterTest, reaches_beyond_the_box_by_the_growth_and_no_further) {
  const vision::PersonMasks masks = make().segment(image_of({{{0, 0, 320, 240}, 1}}), {person({100, 60, 80, 120})}, 4);
  EXPECT_EQ(masks.at(23, 30), 1);  // 92 to 96 px
  EXPECT_EQ(masks.at(21, 30), 0);
  EXPECT_EQ(masks.at(46, 30), 1);
  EXPECT_EQ(masks.at(47, 30), 0);
  EXPECT_EQ(masks.at(30, 12), 1);
  EXPECT_EQ(masks.at(30, 11), 0);
}

TEST_F(PersonSegmenterTest, takes_people_that_the_image_cuts_off) {
  const cv::Rect body(280, 100, 40, 140);
  const vision::PersonMasks masks = make().segment(image_of({{body, 1}}), {person({270, 90, 50, 150})}, 4);
  EXPECT_NEAR(area_of(masks, 1), 350, 30);
  EXPECT_EQ(masks.at(79, 59), 1);
}

TEST_F(PersonSegmenterTest, gives_a_shared_place_to_the_more_probable_person) {
  const cv::Mat left = image_of({{{40, 60, 120, 120}, 0.9}});
  PersonSegmenter segmenter = make();
  const std::vector<vision::Detection> both = {person({40, 60, 120, 120}), person({120, 60, 120, 130})};
  segmenter.segment(left, both, 4);
  // The second box is computed on an image with more red there; the first keeps its last mask.
  const vision::PersonMasks masks =
      segmenter.segment(image_of({{{120, 60, 120, 130}, 1}}), {both[1], person({40, 60, 121, 120})}, 1);
  EXPECT_EQ(masks.at(35, 30), 1);
  EXPECT_EQ(masks.at(20, 30), 2);
}

TEST_F(PersonSegmenterTest, computes_the_largest_people) {
  const cv::Mat image = image_of({{{0, 0, 320, 240}, 1}});
  const vision::PersonMasks masks =
      make(2).segment(image, {person({10, 10, 20, 40}), person({60, 10, 80, 160}), person({200, 10, 60, 120})}, 4);
  EXPECT_EQ(runs, 2);
  EXPECT_EQ(area_of(masks, 1), 0);
  EXPECT_GT(area_of(masks, 2), area_of(masks, 3));
  EXPECT_GT(area_of(masks, 3), 0);
}

TEST_F(PersonSegmenterTest, moves_and_scales_the_last_mask_with_its_box_when_time_is_short) {
  PersonSegmenter segmenter = make();
  segmenter.segment(image_of({{{120, 80, 40, 80}, 1}}), {person({100, 70, 80, 100})}, 4);
  // Half as large again, from 100, 70 to 110, 60: the body goes from (20, 10, 40, 80) to (30, 15, 60, 120) in the box.
  const vision::PersonMasks masks = segmenter.segment(image_of({}), {person({110, 60, 120, 150})}, 0);
  EXPECT_EQ(runs, 1);
  const cv::Rect body(140, 75, 60, 120);
  EXPECT_NEAR(area_of(masks, 1), body.area() / 16, 40);
  EXPECT_EQ(masks.at(36, 20), 1);
  EXPECT_EQ(masks.at(33, 20), 0);
  EXPECT_EQ(masks.at(48, 47), 1);
}

TEST_F(PersonSegmenterTest, has_no_mask_of_a_new_person_when_there_is_no_time) {
  PersonSegmenter segmenter = make();
  const cv::Mat image = image_of({{{0, 0, 320, 240}, 1}});
  EXPECT_TRUE(segmenter.segment(image, {person({10, 10, 50, 100})}, 0).empty());
  segmenter.segment(image, {person({10, 10, 50, 100})}, 4);
  EXPECT_TRUE(segmenter.segment(image, {person({200, 10, 50, 100})}, 0).empty());
}

TEST_F(PersonSegmenterTest, computes_first_who_has_none_then_who_has_waited_longest) {
  PersonSegmenter segmenter = make();
  const cv::Mat red = image_of({{{0, 0, 320, 240}, 1}}), black = image_of({});
  const std::vector<vision::Detection> two = {person({10, 10, 100, 200}), person({200, 10, 80, 160})};
  segmenter.segment(red, two, 1);  // the larger one
  segmenter.segment(red, two, 1);  // the other one, which has none
  const vision::PersonMasks third = segmenter.segment(black, two, 1);
  EXPECT_EQ(area_of(third, 1), 0);  // the larger one again
  EXPECT_GT(area_of(third, 2), 0);
}

TEST_F(PersonSegmenterTest, depends_on_this_frame_alone_when_all_masks_are_computed) {
  PersonSegmenter used = make(), unused = make();
  const std::vector<vision::Detection> found = {person({10, 10, 100, 200}), person({90, 10, 80, 160})};
  used.segment(image_of({{{0, 0, 320, 240}, 1}}), found, 4);
  const cv::Mat image = image_of({{{30, 20, 60, 150}, 0.8}, {{100, 30, 50, 100}, 0.7}});
  EXPECT_EQ(used.segment(image, found, 4).labels, unused.segment(image, found, 4).labels);
}

TEST_F(PersonSegmenterTest, has_no_masks_without_people_or_an_image) {
  PersonSegmenter segmenter = make();
  EXPECT_TRUE(segmenter.segment(image_of({}), {}, 4).empty());
  EXPECT_TRUE(segmenter.segment(image_of({}), {person({10, 10, 50, 90}, "dog")}, 4).empty());
  EXPECT_TRUE(segmenter.segment(image_of({}), {person({10, 10, 0, 90})}, 4).empty());
  EXPECT_TRUE(segmenter.segment({}, {person({10, 10, 50, 90})}, 4).empty());
  EXPECT_THROW(segmenter.segment(cv::Mat(9, 9, CV_8UC1), {}, 4), std::invalid_argument);
}

TEST_F(PersonSegmenterTest, knows_no_more_people_than_labels_can_name) {
  std::vector<vision::Detection> many(300, person({10, 10, 50, 100}, "chair"));
  many[299] = person({10, 10, 50, 100});
  EXPECT_TRUE(make().segment(image_of({{{0, 0, 320, 240}, 1}}), many, 4).empty());
}

/// What the segmenter says of a file.
std::string refusal(const std::string& path) {
  MaskConfig config;
  config.model_path = path;
  config.engine = "cpu";
  try {
    PersonSegmenter segmenter(config);
  } catch (const ModelError& error) {
    return error.what();
  }
  return "taken";
}

TEST(PersonSegmenterFileTest, refuses_files_that_are_no_network_for_masks) {
  EXPECT_THAT(refusal("/nowhere/masks.onnx"), AllOf(HasSubstr("/nowhere/masks.onnx cannot be read: No such file"),
                                                    HasSubstr("setup.sh"), HasSubstr("detector.mask_model")));
  const rtd::test::TemporaryFolder folder;
  const std::string path = folder.file("masks.onnx");
  const auto write = [&](const std::string& bytes) { folder.write("masks.onnx", bytes); };
  write("no network");
  EXPECT_THAT(refusal(path), HasSubstr("is not an ONNX model"));
  test::TinyNetwork network;
  write(test::tiny_network_onnx(network));
  EXPECT_THAT(refusal(path), AllOf(HasSubstr("is not a network for masks"), HasSubstr("expected 1x1x64x64")));
  network.metadata = {{"rtd.decoder", "yolov5"}};
  write(test::tiny_network_onnx(network));
  EXPECT_THAT(refusal(path), HasSubstr("is a network for 'yolov5', expected 'person_mask'"));
}

TEST(PersonSegmenterFileTest, refuses_the_real_network_cut_off_anywhere) {
  const std::string real = test::mask_network();
  if (real.empty()) GTEST_SKIP() << "no network for masks: deploy/setup.sh --models";
  const rtd::test::TemporaryFolder folder;
  const std::string bytes = rtd::test::read_text(real);
  for (std::size_t size = 1000; size + 8 < bytes.size(); size += bytes.size() / 9) {
    const std::string path = folder.write("cut_off.onnx", bytes.substr(0, size));
    EXPECT_THAT(refusal(path), HasSubstr(path)) << size;
  }
  EXPECT_EQ(refusal(real), "taken");
}

}  // namespace
}  // namespace rtd::detector
