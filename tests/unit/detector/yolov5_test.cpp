// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>

#include "services/detector/core/decoder.hpp"

namespace rtd::detector {
namespace {

using ::testing::FloatNear;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();
constexpr HeadLayout kStride8 = {8, {{{10, 13}, {16, 30}, {33, 23}}}};

float sigmoid_of(float x) {
  return 1.0F / (1.0F + std::exp(-x));
}

/// One head whose cells are all silent (objectness -20) until set.
class Head {
 public:
  Head(int rows, int cols, int class_count, HeadLayout layout = kStride8)
      : rows_(rows),
        cols_(cols),
        class_count_(class_count),
        layout_(layout),
        logits_(static_cast<std::size_t>(3 * (5 + class_count) * rows * cols), 0.0F) {
    for (int a = 0; a < 3; ++a)
      for (int r = 0; r < rows; ++r)
        for (int c = 0; c < cols; ++c) at(a, 4, r, c) = -20.0F;
  }
  float& at(int anchor, int plane, int row, int col) {
    return logits_[static_cast<std::size_t>(((anchor * (5 + class_count_) + plane) * rows_ + row) * cols_ + col)];
  }
  HeadLogits view() const { return {logits_.data(), rows_, cols_, layout_}; }
  void randomise(std::mt19937_64& random) {
    std::normal_distribution<float> normal(0.0F, 2.0F);
    for (float& logit : logits_) logit = normal(random);
  }

 private:
  int rows_, cols_, class_count_;
  HeadLayout layout_;
  std::vector<float> logits_;
};

/// Decodes every cell, then filters: slow, obvious.
std::vector<Candidate> decode_everything(Head& head, int rows, int cols, int class_count, const DecodeConfig& config) {
  std::vector<Candidate> all;
  for (int a = 0; a < 3; ++a)
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < cols; ++c) {
        Candidate box;
        for (int k = 1; k < class_count; ++k)
          if (head.at(a, 5 + k, r, c) > head.at(a, 5 + box.class_index, r, c)) box.class_index = k;
        const float objectness = sigmoid_of(head.at(a, 4, r, c));
        box.score = objectness * sigmoid_of(head.at(a, 5 + box.class_index, r, c));
        const float x = (2 * sigmoid_of(head.at(a, 0, r, c)) - 0.5F + static_cast<float>(c)) * 8;
        const float y = (2 * sigmoid_of(head.at(a, 1, r, c)) - 0.5F + static_cast<float>(r)) * 8;
        const Anchor anchor = kStride8.anchors[static_cast<std::size_t>(a)];
        const float w = std::pow(2 * sigmoid_of(head.at(a, 2, r, c)), 2.0F) * anchor.width_px;
        const float h = std::pow(2 * sigmoid_of(head.at(a, 3, r, c)), 2.0F) * anchor.height_px;
        box = {box.class_index, box.score, x - w / 2, y - h / 2, x + w / 2, y + h / 2};
        if (objectness >= config.objectness_threshold && box.score >= config.confidence_threshold) all.push_back(box);
      }
  return all;
}

TEST(YoloDecoder, decodes_one_cell_as_computed_by_hand) {
  Head head(4, 6, 3);
  head.at(1, 0, 2, 5) = 0.0F;                // x = (2*0.5 - 0.5 + 5) * 8 = 44
  head.at(1, 1, 2, 5) = std::log(3.0F);      // y = (2*0.75 - 0.5 + 2) * 8 = 24
  head.at(1, 2, 2, 5) = 0.0F;                // w = 1 * 16
  head.at(1, 3, 2, 5) = -std::log(3.0F);     // h = (2*0.25)^2 * 30 = 7.5
  head.at(1, 4, 2, 5) = std::log(4.0F);      // objectness 0.8
  head.at(1, 5 + 2, 2, 5) = std::log(9.0F);  // class 2: 0.9

  const std::vector<Candidate> found = decode_heads({head.view()}, 3, {});

  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].class_index, 2);
  EXPECT_NEAR(found[0].score, 0.72F, 1e-5F);
  EXPECT_NEAR(found[0].left_px, 36.0F, 1e-3F);
  EXPECT_NEAR(found[0].right_px, 52.0F, 1e-3F);
  EXPECT_NEAR(found[0].top_px, 20.25F, 1e-3F);
  EXPECT_NEAR(found[0].bottom_px, 27.75F, 1e-3F);
}

TEST(YoloDecoder, equals_decoding_every_cell_on_random_logits) {
  constexpr int kRows = 15, kCols = 20, kClasses = 80;
  std::mt19937_64 random(7);
  Head head(kRows, kCols, kClasses);
  head.randomise(random);
  for (const double threshold : {0.05, 0.25, 0.6}) {
    const DecodeConfig config{threshold, 0.3, 0.45, 100};

    const std::vector<Candidate> found = decode_heads({head.view()}, kClasses, config);

    const std::vector<Candidate> expected = decode_everything(head, kRows, kCols, kClasses, config);
    ASSERT_EQ(found.size(), expected.size()) << "threshold " << threshold;
    ASSERT_GT(expected.size(), 10U);
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].class_index, expected[i].class_index);
      EXPECT_NEAR(found[i].score, expected[i].score, 1e-5F);
      EXPECT_NEAR(found[i].left_px, expected[i].left_px, 1e-3F);
      EXPECT_NEAR(found[i].bottom_px, expected[i].bottom_px, 1e-3F);
    }
  }
}

TEST(YoloDecoder, finds_nothing_where_no_objectness_passes) {
  const Head head(60, 80, 80);
  EXPECT_THAT(decode_heads({head.view()}, 80, {}), IsEmpty());
}

TEST(YoloDecoder, ignores_not_a_number) {
  for (const int plane : {0, 1, 2, 3, 4}) {
    Head head(2, 2, 2);
    head.at(0, 4, 0, 0) = 10.0F;
    head.at(0, 5, 0, 0) = 10.0F;
    ASSERT_THAT(decode_heads({head.view()}, 2, {}), SizeIs(1));
    head.at(0, plane, 0, 0) = kNotANumber;
    EXPECT_THAT(decode_heads({head.view()}, 2, {}), IsEmpty()) << "plane " << plane;
  }
}

TEST(YoloDecoder, takes_the_other_class_when_one_is_not_a_number) {
  Head head(2, 2, 2);
  head.at(0, 4, 0, 0) = 10.0F;
  head.at(0, 5, 0, 0) = kNotANumber;
  head.at(0, 6, 0, 0) = 3.0F;
  const std::vector<Candidate> found = decode_heads({head.view()}, 2, {});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].class_index, 1);
}

TEST(YoloDecoder, survives_infinite_logits) {
  Head head(2, 2, 2);
  head.at(0, 4, 0, 0) = std::numeric_limits<float>::infinity();
  head.at(0, 5, 0, 0) = std::numeric_limits<float>::infinity();
  head.at(0, 2, 0, 0) = -std::numeric_limits<float>::infinity();
  const std::vector<Candidate> found = decode_heads({head.view()}, 2, {});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_THAT(found[0].score, FloatNear(1.0F, 1e-6F));
}

TEST(Suppression, keeps_the_better_of_two_overlapping_boxes_of_a_class) {
  const Candidate weak{0, 0.5F, 0, 0, 10, 10}, strong{0, 0.9F, 1, 0, 11, 10};
  const std::vector<Candidate> kept = suppress_non_maxima({weak, strong}, {});
  ASSERT_THAT(kept, SizeIs(1));
  EXPECT_FLOAT_EQ(kept[0].score, 0.9F);
}

TEST(Suppression, keeps_overlapping_boxes_of_different_classes) {
  EXPECT_THAT(suppress_non_maxima({{0, 0.5F, 0, 0, 10, 10}, {1, 0.9F, 0, 0, 10, 10}}, {}), SizeIs(2));
}

TEST(Suppression, keeps_boxes_at_the_threshold_and_drops_those_above) {
  const Candidate first{0, 0.9F, 0, 0, 10, 10}, half{0, 0.8F, 0, 0, 10, 5};  // IoU 0.5
  EXPECT_THAT(suppress_non_maxima({first, half}, {0.25, 0.1, 0.5, 100}), SizeIs(2));
  EXPECT_THAT(suppress_non_maxima({first, half}, {0.25, 0.1, 0.49, 100}), SizeIs(1));
}

TEST(Suppression, keeps_the_best_when_there_are_too_many) {
  std::vector<Candidate> many;
  for (int i = 0; i < 50; ++i) {
    const auto left_px = static_cast<float>(20 * i);
    many.push_back({0, 0.01F * static_cast<float>(i + 1), left_px, 0, left_px + 10, 10});
  }
  const std::vector<Candidate> kept = suppress_non_maxima(many, {0.25, 0.1, 0.45, 3});
  ASSERT_THAT(kept, SizeIs(3));
  EXPECT_FLOAT_EQ(kept[0].score, 0.50F);
  EXPECT_FLOAT_EQ(kept[2].score, 0.48F);
}

TEST(Suppression, is_the_same_in_every_run_for_equal_scores) {
  const Candidate first{0, 0.5F, 0, 0, 10, 10}, second{0, 0.5F, 1, 0, 11, 10};
  const std::vector<Candidate> kept = suppress_non_maxima({first, second}, {});
  ASSERT_THAT(kept, SizeIs(1));
  EXPECT_FLOAT_EQ(kept[0].left_px, 0.0F);
}

TEST(IntersectionOverUnion, is_as_computed_by_hand) {
  const Candidate a{0, 1, 0, 0, 4, 4}, b{0, 1, 2, 2, 6, 6}, apart{0, 1, 10, 10, 12, 12}, empty{0, 1, 1, 1, 1, 1};
  EXPECT_FLOAT_EQ(intersection_over_union(a, b), 4.0F / 28.0F);
  EXPECT_FLOAT_EQ(intersection_over_union(a, a), 1.0F);
  EXPECT_FLOAT_EQ(intersection_over_union(a, apart), 0.0F);
  EXPECT_FLOAT_EQ(intersection_over_union(a, empty), 0.0F);
}

}  // namespace
}  // namespace rtd::detector
