// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/tracking/matcher.hpp"

#include <gmock/gmock.h>

namespace rtd::slam {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

msg::Feature feature_at(float u, float v, std::uint8_t pattern, float depth_m = 0) {
  msg::Feature feature{};
  feature.u_px = u;
  feature.v_px = v;
  feature.depth_m = depth_m;
  feature.descriptor.fill(pattern);
  return feature;
}

FramePtr frame_of(std::vector<msg::Feature> features) {
  auto frame = std::make_shared<Frame>();
  frame->width_px = 640;
  frame->height_px = 480;
  frame->features = std::move(features);
  frame->grid = vision::FeatureGrid(frame->features, 640, 480);
  return frame;
}

SearchPoint look(float u, float v, const msg::Descriptor& descriptor, std::uint32_t tag = 0) {
  SearchPoint point;
  point.window = {u, v, 10, 0, 7};
  point.inverse_depth_per_m = 0.5F;
  point.descriptor = &descriptor;
  point.tag = tag;
  return point;
}

TEST(MatchProjected, takes_the_most_similar_in_the_window) {
  const auto frame = frame_of({feature_at(100, 100, 0x0F), feature_at(104, 100, 0x00), feature_at(300, 300, 0x00)});
  msg::Descriptor wanted{};
  const std::vector<SearchPoint> points{look(100, 100, wanted, 42)};
  const auto matches = match_projected(*frame, points, {}, {});
  ASSERT_THAT(matches, SizeIs(1));
  EXPECT_EQ(matches[0].feature, 1U);
  EXPECT_EQ(matches[0].tag, 42U);
  EXPECT_EQ(matches[0].hamming, 0);
}

TEST(MatchProjected, refuses_what_is_unlike_taken_or_ambiguous) {
  const auto frame = frame_of({feature_at(100, 100, 0x01), feature_at(104, 100, 0x02)});
  msg::Descriptor near{}, far{};
  far.fill(0xFF);
  const std::vector<SearchPoint> unlike{look(100, 100, far)}, alike{look(100, 100, near)};
  EXPECT_THAT(match_projected(*frame, unlike, {}, {}), IsEmpty()) << "224 bits differ";
  EXPECT_THAT(match_projected(*frame, alike, {1, 1}, {}), IsEmpty()) << "taken";
  EXPECT_THAT(match_projected(*frame, alike, {}, {100, 0.8, RotationCheck::kOff}), IsEmpty()) << "two equal candidates";
  EXPECT_THAT(match_projected(*frame, alike, {0, 1}, {100, 0.8, RotationCheck::kOff}), SizeIs(1));
}

TEST(MatchProjected, gives_a_feature_to_the_point_it_resembles_most) {
  const auto frame = frame_of({feature_at(100, 100, 0x01)});
  msg::Descriptor worse{}, better{};
  better.fill(0x01);
  const std::vector<SearchPoint> points{look(101, 100, worse, 1), look(99, 100, better, 2)};
  const auto matches = match_projected(*frame, points, {}, {});
  ASSERT_THAT(matches, SizeIs(1));
  EXPECT_EQ(matches[0].tag, 2U);
}

TEST(MatchProjected, refuses_a_feature_at_the_wrong_depth) {
  msg::Descriptor wanted{};
  const std::vector<SearchPoint> points{look(100, 100, wanted)};  // predicted at 2 m
  EXPECT_THAT(match_projected(*frame_of({feature_at(100, 100, 0, 2.1F)}), points, {}, {}), SizeIs(1));
  EXPECT_THAT(match_projected(*frame_of({feature_at(100, 100, 0, 1.0F)}), points, {}, {}), IsEmpty());
}

TEST(KeepConsistentRotation, drops_the_lone_turners) {
  std::vector<Match> matches;
  std::vector<float> change;
  for (std::uint32_t i = 0; i < 40; ++i) {
    matches.push_back({i, i, 0});
    change.push_back(i % 10 == 0 ? 3.0F + 0.3F * static_cast<float>(i) : 0.1F);
  }
  const auto kept = keep_consistent_rotation(matches, change);
  EXPECT_GE(kept.size(), 36U);
  EXPECT_LE(kept.size(), 38U);
  for (const Match& match : kept) EXPECT_TRUE(match.feature % 10 != 0 || kept.size() > 36);
}

TEST(MatchByDescriptor, wants_mutual_and_distinct_neighbours) {
  const auto frame = frame_of({feature_at(0, 0, 0x00), feature_at(50, 0, 0x3F), feature_at(90, 0, 0xFF)});
  const auto other = frame_of({feature_at(0, 0, 0x00), feature_at(5, 0, 0x01), feature_at(9, 0, 0xFF)});
  const std::vector<std::uint32_t> all{0, 1, 2};
  const auto matches = match_by_descriptor(*frame, *other, all, {60, 0.8, RotationCheck::kOff});
  ASSERT_THAT(matches, SizeIs(2)) << "feature 1 of the other frame is only second choice of feature 0";
  EXPECT_EQ(matches[0].tag, 0U);
  EXPECT_EQ(matches[1].tag, 2U);
  EXPECT_EQ(matches[1].feature, 2U);
}

TEST(MatchByDescriptor, survives_empty_frames) {
  const auto frame = frame_of({});
  EXPECT_THAT(match_by_descriptor(*frame, *frame, {}, {}), IsEmpty());
  const auto other = frame_of({feature_at(0, 0, 1)});
  const std::vector<std::uint32_t> one{0};
  EXPECT_THAT(match_by_descriptor(*frame, *other, one, {}), IsEmpty());
}

}  // namespace
}  // namespace rtd::slam
