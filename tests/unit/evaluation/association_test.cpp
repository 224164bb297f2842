// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "services/evaluation/core/trajectory/trajectory_error.hpp"

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

}  // namespace
}  // namespace rtd::eval
