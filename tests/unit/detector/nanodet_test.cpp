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

constexpr int kTwoClasses = 2, kFewBins = 8, kHeadRows = 2, kHeadCols = 3, kStridePx = 16;

/// A head whose cells are all silent until set; each distance is spread evenly over all bins.
class Distances {
 public:
  Distances() {
    for (int i = 0; i < kTwoClasses * kHeadRows * kHeadCols; ++i) logits_[static_cast<std::size_t>(i)] = -20.0F;
  }
  float& at(int plane, int row, int col) {
    return logits_[static_cast<std::size_t>((plane * kHeadRows + row) * kHeadCols + col)];
  }
  /// All of the distribution of a side in one bin.
  void set_distance(int side, int bin, int row, int col) { at(kTwoClasses + side * kFewBins + bin, row, col) = 50.0F; }
  std::vector<Candidate> decode(const DecodeConfig& config = {}) const {
    return decode_nanodet({{logits_.data(), kHeadRows, kHeadCols, kStridePx, kFewBins}}, kTwoClasses, config);
  }

 private:
  std::vector<float> logits_ =
      std::vector<float>(static_cast<std::size_t>((kTwoClasses + 4 * kFewBins) * kHeadRows * kHeadCols), 0.0F);
};

TEST(NanodetDecoder, decodes_a_cell_as_computed_by_hand) {
  Distances head;
  head.at(1, 1, 2) = 0.0F;  // score 0.5; centre (2.5 * 16, 1.5 * 16) = (40, 24)
  head.set_distance(0, 2, 1, 2);
  head.set_distance(1, 1, 1, 2);
  head.set_distance(2, 7, 1, 2);  // the bottom: the mean of 0 to 7 is 3.5
  const std::vector<Candidate> found = head.decode();
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].class_index, 1);
  EXPECT_FLOAT_EQ(found[0].score, 0.5F);
  EXPECT_NEAR(found[0].left_px, 40 - 2 * 16, 1e-3F);
  EXPECT_NEAR(found[0].top_px, 24 - 16, 1e-3F);
  EXPECT_NEAR(found[0].right_px, 40 + 7 * 16, 1e-3F);
  EXPECT_NEAR(found[0].bottom_px, 24 + 3.5F * 16, 1e-3F);
}

TEST(NanodetDecoder, drops_scores_below_the_threshold) {
  Distances head;
  head.at(0, 0, 0) = std::log(0.2F / 0.8F);
  EXPECT_THAT(head.decode(), IsEmpty());
  EXPECT_THAT(head.decode({.confidence_threshold = 0.19}), SizeIs(1));
}

TEST(NanodetDecoder, takes_no_box_from_numbers_that_are_none) {
  const float not_a_number = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  for (const float spoiled : {not_a_number, infinity}) {
    Distances head;
    head.at(0, 1, 1) = 5.0F;
    ASSERT_THAT(head.decode(), SizeIs(1));
    head.at(kTwoClasses + 2 * kFewBins + 3, 1, 1) = spoiled;
    EXPECT_THAT(head.decode(), IsEmpty());
  }
  Distances head;
  head.at(0, 1, 1) = head.at(1, 1, 1) = not_a_number;
  EXPECT_THAT(head.decode(), IsEmpty());
}

TEST(NanodetDecoder, is_recognised_with_any_number_of_bins_and_order_of_heads) {
  const NetworkFacts facts{{416, 320}, 80, yolov5_heads()};
  const auto fits = [&](int planes, int second_planes) {
    const std::vector<RawOutput> outputs = {
        {nullptr, {1, planes, 20, 26}}, {nullptr, {1, second_planes, 10, 13}}, {nullptr, {1, planes, 40, 52}}};
    int families = 0;
    for (const DecoderFamily& family : decoder_families()) families += family.make(facts, outputs) ? 1 : 0;
    const bool nanodet = nanodet_family().make(facts, outputs) != nullptr;
    EXPECT_EQ(families, nanodet ? 1 : 0) << planes;
    return nanodet;
  };
  EXPECT_TRUE(fits(80 + 32, 80 + 32));
  EXPECT_TRUE(fits(80 + 44, 80 + 44));
  EXPECT_FALSE(fits(80 + 43, 80 + 43));
  EXPECT_FALSE(fits(80 + 32, 80 + 44));
  EXPECT_FALSE(fits(80, 80));
  EXPECT_FALSE(fits(80 + 4, 80 + 4)) << "one bin is no distribution";
}

}  // namespace
}  // namespace rtd::detector
