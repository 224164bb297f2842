// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "services/launcher/core/run/record_builder.hpp"
#include "tests/unit/launcher/run_messages.hpp"

namespace rtd::launcher {
namespace {

using testing::ElementsAre;
using testing::Field;

std::vector<run_record::SampleFrame> run_samples(SampleKeeper& keeper, std::uint64_t frames) {
  for (std::uint64_t seq = 0; seq < frames; ++seq) {
    if (keeper.wants(seq)) keeper.add_image(seq, {1, 2, 3});
    keeper.add_features(seq, *features_of(seq));
  }
  return keeper.samples();
}

TEST(sample_keeper, spreads_the_wanted_number_over_a_known_length) {
  SampleKeeper keeper(12, 210);
  const auto samples = run_samples(keeper, 210);
  ASSERT_EQ(samples.size(), 12U);
  EXPECT_EQ(samples[0].seq, 0U);
  EXPECT_EQ(samples[11].seq, 198U);
  EXPECT_EQ(samples[3].features.size(), 3U);
}

TEST(sample_keeper, keeps_where_the_static_points_are) {
  SampleKeeper keeper(1, 1);
  auto features = *features_of(0);
  features.intrinsics = {500, 400, 320, 240};
  for (std::size_t i = 0; i < 3; ++i) features.features[i] = {.u_px = 420, .v_px = 140, .u_raw_px = 9, .depth_m = 2};
  features.features[1].flags = msg::kFeatureRemoved;
  features.features[2].depth_m = 0;
  keeper.add_image(0, {1});
  keeper.add_features(0, features);
  const std::vector<run_record::SeenPoint> points = keeper.samples().at(0).points;
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].u_raw_px, 9);
  EXPECT_THAT(points[0].p_camera_m, ElementsAre(0.4F, -0.5F, 2));
}

TEST(sample_keeper, stays_even_and_bounded_over_an_unknown_length) {
  SampleKeeper keeper(12);
  const auto samples = run_samples(keeper, 5000);
  ASSERT_GE(samples.size(), 10U);
  ASSERT_LE(samples.size(), 12U);
  EXPECT_GT(samples.back().seq, 4000U);
  for (std::size_t i = 1; i < samples.size(); ++i) EXPECT_LT(samples[i].seq - samples[i - 1].seq, 1100U);
}

TEST(sample_keeper, finds_the_frame_of_masks_by_its_stamp) {
  SampleKeeper keeper(12, 24);
  keeper.expect_masks(4, 400);
  keeper.add_masks(500, {1, 1, {2}});  // of a frame that is not kept
  keeper.add_masks(400, {1, 1, {1}});
  keeper.add_image(4, {1});
  keeper.add_features(4, *features_of(4));
  ASSERT_EQ(keeper.samples().size(), 1U);
  EXPECT_THAT(keeper.samples()[0].masks.labels, ElementsAre(1));
}

TEST(sample_keeper, needs_picture_and_features) {
  SampleKeeper keeper(12, 24);
  keeper.add_image(0, {1});
  keeper.add_features(2, *features_of(2));
  keeper.add_image(4, {1});
  keeper.add_features(4, *features_of(4));
  EXPECT_THAT(keeper.samples(), ElementsAre(Field(&run_record::SampleFrame::seq, 4)));
}

TEST(sample_keeper, believes_no_count_beyond_the_message) {
  SampleKeeper keeper;
  keeper.add_image(0, {1});
  keeper.add_features(0, *features_of(0, 4'000'000'000U));
  EXPECT_EQ(keeper.samples().at(0).features.size(), msg::kMaxFeatures);
}

}  // namespace
}  // namespace rtd::launcher
