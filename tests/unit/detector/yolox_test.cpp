// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/decoder.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace rtd::detector {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr InputSize kSmallInput{64, 32};
constexpr int kThreeClasses = 3, kNumbers = 5 + kThreeClasses;
constexpr int kCells = 8 * 4 + 4 * 2 + 2 * 1;

/// An output whose cells are all silent until set.
class Rows {
 public:
  float* cell(int index) { return numbers_.data() + static_cast<std::ptrdiff_t>(index) * kNumbers; }
  /// A cell with a person-like box of two strides by one at its corner.
  void set(int index, float objectness, int class_index, float class_score) {
    float* const row = cell(index);
    row[2] = std::log(2.0F);
    row[4] = objectness;
    row[5 + class_index] = class_score;
  }
  std::vector<Candidate> decode(const DecodeConfig& config = {}) const {
    return decode_yolox(numbers_, kSmallInput, kThreeClasses, config);
  }

 private:
  std::vector<float> numbers_ = std::vector<float>(static_cast<std::size_t>(kCells * kNumbers), 0.0F);
};

void expect_box(const Candidate& box, float left_px, float top_px, float right_px, float bottom_px) {
  EXPECT_NEAR(box.left_px, left_px, 1e-4F);
  EXPECT_NEAR(box.top_px, top_px, 1e-4F);
  EXPECT_NEAR(box.right_px, right_px, 1e-4F);
  EXPECT_NEAR(box.bottom_px, bottom_px, 1e-4F);
}

TEST(YoloxDecoder, decodes_a_cell_of_each_stride_as_computed_by_hand) {
  Rows rows;
  rows.set(8 * 2 + 5, 0.8F, 1, 0.5F);   // stride 8, row 2, column 5
  rows.cell(8 * 2 + 5)[0] = 0.5F;       // centre (5.5 * 8, 2 * 8) = (44, 16), size 16 x 8
  rows.set(32 + 4 + 3, 1.0F, 0, 0.6F);  // stride 16, row 1, column 3: centre (48, 16), size 32 x 16
  rows.set(32 + 8 + 1, 0.9F, 2, 1.0F);  // stride 32, column 1: centre (32, 0), size 64 x 32
  const std::vector<Candidate> found = rows.decode();
  ASSERT_THAT(found, SizeIs(3));
  expect_box(found[0], 36, 12, 52, 20);
  EXPECT_EQ(found[0].class_index, 1);
  EXPECT_FLOAT_EQ(found[0].score, 0.4F);
  expect_box(found[1], 32, 8, 64, 24);
  EXPECT_EQ(found[1].class_index, 0);
  expect_box(found[2], 0, -16, 64, 16);
  EXPECT_EQ(found[2].class_index, 2);
}

TEST(YoloxDecoder, drops_what_does_not_reach_a_threshold) {
  Rows rows;
  rows.set(0, 0.5F, 0, 0.4F);   // 0.2
  rows.set(1, 0.09F, 0, 1.0F);  // objectness
  EXPECT_THAT(rows.decode(), IsEmpty());
  EXPECT_THAT(rows.decode({.confidence_threshold = 0.15}), SizeIs(1));
  EXPECT_THAT(rows.decode({.confidence_threshold = 0.05, .objectness_threshold = 0.05}), SizeIs(2));
}

TEST(YoloxDecoder, takes_no_box_from_numbers_that_are_none) {
  for (const float spoiled : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    for (const int number : {0, 1, 2, 3}) {
      Rows rows;
      rows.set(7, 0.9F, 0, 0.9F);
      ASSERT_THAT(rows.decode(), SizeIs(1));
      rows.cell(7)[number] = spoiled;
      EXPECT_THAT(rows.decode(), IsEmpty()) << number;
    }
  }
  Rows rows;
  rows.set(7, std::numeric_limits<float>::quiet_NaN(), 0, 0.9F);
  EXPECT_THAT(rows.decode(), IsEmpty());
}

TEST(YoloxDecoder, never_gives_a_score_above_one) {
  Rows rows;
  rows.set(3, 1e30F, 0, 1e30F);
  for (const Candidate& box : rows.decode()) EXPECT_LE(box.score, 1.0F);
}

TEST(DecoderFamilies, are_recognised_by_the_shapes_of_their_outputs) {
  const NetworkFacts facts{{416, 416}, 80, yolov5_heads()};
  const auto titles = [&](const std::vector<RawOutput>& outputs) {
    std::string text;
    for (const DecoderFamily& family : decoder_families())
      if (family.make(facts, outputs)) text += family.title;
    return text;
  };
  EXPECT_EQ(titles({{nullptr, {1, 3549, 85}}}), "YOLOX");
  EXPECT_EQ(titles({{nullptr, {1, 255, 13, 13}}, {nullptr, {1, 255, 52, 52}}, {nullptr, {1, 255, 26, 26}}}), "YOLOv5");
  EXPECT_EQ(titles({{nullptr, {1, 3549, 6}}}), "") << "one class";
  EXPECT_EQ(titles({{nullptr, {1, 3548, 85}}}), "") << "another input";
  EXPECT_EQ(titles({{nullptr, {1, 255, 52, 52}}}), "") << "one of three";
  EXPECT_EQ(titles({{}}), "");
  EXPECT_EQ(titles({}), "");
}

TEST(DecoderFamilies, say_how_many_classes_other_outputs_have) {
  const NetworkFacts facts{{416, 416}, 80, yolov5_heads()};
  const DecoderFamily yolox = yolox_family();
  EXPECT_EQ(yolox.classes_in(facts, {{nullptr, {1, 3549, 8}}}), 3);
  EXPECT_EQ(yolox.classes_in(facts, {{nullptr, {1, 3549, 5}}}), std::nullopt);
  EXPECT_EQ(yolov5_family().classes_in(facts, {{nullptr, {1, 3549, 8}}}), std::nullopt);
}

}  // namespace
}  // namespace rtd::detector
