// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "services/evaluation/core/trajectory/evaluation.hpp"
#include "services/evaluation/core/trajectory/trajectory_error.hpp"
#include "tests/unit/evaluation/eval_paths.hpp"

namespace rtd::eval {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kMs = 1'000'000;

std::vector<std::int64_t> ms(std::initializer_list<std::int64_t> values) {
  std::vector<std::int64_t> stamps;
  for (const auto v : values) stamps.push_back(v * kMs);
  return stamps;
}

std::vector<std::pair<std::size_t, std::size_t>> pairs(const std::vector<std::int64_t>& groundtruth,
                                                       const std::vector<std::int64_t>& estimate) {
  std::vector<std::pair<std::size_t, std::size_t>> result;
  for (const auto& [first, second] : geometry::associate(groundtruth, estimate, 20 * kMs))
    result.emplace_back(first, second);
  return result;
}
using P = std::pair<std::size_t, std::size_t>;

TEST(Associate, limit_itself_is_excluded) {
  EXPECT_THAT(pairs(ms({100}), ms({119})), ElementsAre(P{0, 0}));
  EXPECT_THAT(pairs(ms({100}), ms({120})), IsEmpty());
  EXPECT_THAT(pairs(ms({100}), ms({80})), IsEmpty());
  EXPECT_THAT(pairs(ms({100}), ms({81})), ElementsAre(P{0, 0}));
}

TEST(Associate, smallest_difference_wins_and_each_stamp_is_used_once) {
  // Estimate 0 could take 100 (5 ms) but 106 is nearer (1 ms); estimate 1 then has only 100 left.
  EXPECT_THAT(pairs(ms({100, 106}), ms({105, 108})), ElementsAre(P{0, 1}, P{1, 0}));
  EXPECT_THAT(pairs(ms({100}), ms({99, 100, 101})), ElementsAre(P{0, 1}));
}

TEST(Associate, greedy_choice_may_leave_a_stamp_alone) {
  // 10 takes 12 (2 ms); 30 then stays without partner although 0-10 and 12-30 were both possible.
  EXPECT_THAT(pairs(ms({0, 12}), ms({10, 30})), ElementsAre(P{1, 0}));
}

TEST(Associate, tie_goes_to_the_earlier_ground_truth) {
  EXPECT_THAT(pairs(ms({100, 110}), ms({105})), ElementsAre(P{0, 0}));
  EXPECT_THAT(pairs(ms({105}), ms({100, 110})), ElementsAre(P{0, 0}));
}

TEST(Associate, offset_is_added_to_the_estimate) {
  const Trajectory groundtruth = {{.stamp_ns = 1000 * kMs}}, estimate = {{.stamp_ns = 500 * kMs}};
  EXPECT_EQ(ate(estimate, groundtruth).error_m.count, 0U);
  EXPECT_EQ(ate(estimate, groundtruth, {.association = {0.02, 0.5}}).error_m.count, 1U);
  EXPECT_EQ(ate(estimate, groundtruth, {.association = {0.02, -0.5}}).error_m.count, 0U);
}

TEST(Associate, empty_inputs_give_no_pairs) {
  EXPECT_THAT(pairs({}, ms({1})), IsEmpty());
  EXPECT_THAT(pairs(ms({1}), {}), IsEmpty());
}

TEST(Statistics, of_known_values) {
  const Statistics s = summarize({3, 1, 2, 6});
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.mean, 3);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(50.0 / 4));
  EXPECT_DOUBLE_EQ(s.std_dev, std::sqrt(14.0 / 4));
  EXPECT_DOUBLE_EQ(s.min, 1);
  EXPECT_DOUBLE_EQ(s.max, 6);
}

TEST(Statistics, of_nothing_is_not_a_number) {
  const Statistics s = summarize(std::vector<double>{});
  EXPECT_EQ(s.count, 0U);
  EXPECT_TRUE(std::isnan(s.rmse) && std::isnan(s.median) && std::isnan(s.max));
}

TEST(Percentile, is_linear_between_neighbours) {
  EXPECT_DOUBLE_EQ(percentile({40, 10, 30, 20, 50}, 0.5), 30);
  EXPECT_DOUBLE_EQ(percentile({10, 20}, 0.25), 12.5);
  EXPECT_DOUBLE_EQ(percentile({10, 20, 30, 40, 50}, 0.99), 49.6);
  EXPECT_DOUBLE_EQ(percentile({10, 20}, 0), 10);
  EXPECT_DOUBLE_EQ(percentile({10, 20}, 1), 20);
  EXPECT_DOUBLE_EQ(percentile({7}, 0.99), 7);
  EXPECT_TRUE(std::isnan(percentile({}, 0.5)));
}

constexpr std::int64_t kS = 1'000'000'000;

TEST(CoverageOfFrames, counts_frames_with_pose_and_names_lost_spans) {
  const Coverage c = coverage_of_frames({0, kS, 2 * kS, 3 * kS, 4 * kS, 5 * kS}, {kS, 4 * kS});
  EXPECT_EQ(c.frames, 6U);
  EXPECT_EQ(c.tracked, 2U);
  EXPECT_DOUBLE_EQ(c.fraction, 2.0 / 6);
  ASSERT_EQ(c.lost.size(), 3U);
  EXPECT_EQ(c.lost[1].first_ns, 2 * kS);
  EXPECT_EQ(c.lost[1].last_ns, 3 * kS);
  EXPECT_EQ(c.lost[1].frames, 2U);
  EXPECT_EQ(c.lost[1].last_ns - c.lost[1].first_ns, 1'000'000'000);
  EXPECT_EQ(c.lost[2].frames, 1U);
}

TEST(CoverageOfFrames, stamps_rounded_to_microseconds_still_match) {
  EXPECT_EQ(coverage_of_frames({1'000'000'400}, {1'000'000'000}).tracked, 1U);
  EXPECT_EQ(coverage_of_frames({1'000'000'000}, {1'010'000'000}).tracked, 0U);
}

TEST(CoverageOfFrames, poses_of_no_frame_do_not_count) {
  const Coverage c = coverage_of_frames({kS}, {kS, 2 * kS, 3 * kS});
  EXPECT_EQ(c.tracked, 1U);
  EXPECT_DOUBLE_EQ(c.fraction, 1.0);
  EXPECT_TRUE(c.lost.empty());
}

TEST(CoverageOfFrames, of_nothing_is_zero) {
  EXPECT_EQ(coverage_of_frames({}, {kS}).fraction, 0);
}

TEST(CoverageOfSpan, gaps_and_ends_longer_than_the_limit_are_lost) {
  // 10 s; poses every 0.4 s from 2 s to 4 s and from 5 s to 9.8 s: lost are 2 s at the start and 1 s in the middle.
  std::vector<std::int64_t> poses;
  for (int i = 0; i <= 5; ++i) poses.push_back(2 * kS + i * kS * 2 / 5);
  for (int i = 0; i <= 12; ++i) poses.push_back(5 * kS + i * kS * 2 / 5);
  const Coverage c = coverage_of_span(0, 10 * kS, poses, 0.5);
  EXPECT_NEAR(c.fraction, 0.7, 1e-12);
  ASSERT_EQ(c.lost.size(), 2U);
  EXPECT_EQ(c.lost[0].last_ns - c.lost[0].first_ns, 2'000'000'000);
  EXPECT_EQ(c.lost[1].first_ns, 4 * kS);
  EXPECT_EQ(c.lost[1].last_ns, 5 * kS);
}

TEST(CoverageOfSpan, poses_outside_the_span_cover_nothing) {
  const Coverage c = coverage_of_span(10 * kS, 10 * kS + kS / 5, {kS, 20 * kS}, 0.5);
  EXPECT_EQ(c.fraction, 0);
  EXPECT_EQ(c.tracked, 0U);
  ASSERT_EQ(c.lost.size(), 1U);
}

TEST(Evaluate, uses_the_frame_list_when_there_is_one) {
  const Trajectory groundtruth = testing_support::winding_path(40, 0.1);
  const Trajectory estimate(groundtruth.begin() + 10, groundtruth.end());
  EXPECT_DOUBLE_EQ(evaluate(estimate, groundtruth, {}, stamps_of(groundtruth)).coverage.fraction, 0.75);
  const Evaluation by_span = evaluate(estimate, groundtruth);
  EXPECT_NEAR(by_span.coverage.fraction, 29.0 / 39, 1e-9);
  EXPECT_EQ(by_span.ate.error_m.count, 30U);
  EXPECT_EQ(by_span.estimate_poses, 30U);
  EXPECT_EQ(by_span.groundtruth_poses, 40U);
}

TEST(Evaluate, applies_offset_and_scale_to_every_measure) {
  const Trajectory groundtruth = testing_support::winding_path(60, 0.1);
  Trajectory estimate = testing_support::moved(groundtruth, testing_support::some_transform(), 0.25);
  for (StampedPose& pose : estimate) pose.stamp_ns -= 5 * kS;
  EvaluationOptions options;
  options.association.offset_s = 5;
  options.alignment = AlignmentKind::kSimilarity;
  const Evaluation e = evaluate(estimate, groundtruth, options);
  EXPECT_NEAR(e.ate.error_m.max, 0, 1e-9);
  EXPECT_NEAR(e.rpe_per_second.translation_m.max, 0, 1e-9);
  EXPECT_NEAR(e.rpe_per_frame.translation_m.max, 0, 1e-9);
  EXPECT_DOUBLE_EQ(e.coverage.fraction, 1.0);
}

}  // namespace
}  // namespace rtd::eval
