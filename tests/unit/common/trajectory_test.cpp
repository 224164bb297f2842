// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <set>
#include <sstream>
#include <tuple>

#include "common/geometry/pose_list.hpp"
#include "common/msg/stamps.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::geometry {
namespace {

Trajectory read(const std::string& text) {
  return read_pose_list(text, "est.txt").poses;
}

std::string error_of(const std::string& text) {
  try {
    read(text);
  } catch (const TrajectoryError& error) {
    return error.what();
  }
  return "no error";
}

using Stamps = std::vector<std::int64_t>;

/// Every pair that is close enough, the closest first: what associate() gives, by its definition.
std::vector<std::pair<std::size_t, std::size_t>> associate_all(const Stamps& first, const Stamps& second,
                                                               std::int64_t most) {
  std::vector<std::tuple<std::int64_t, std::size_t, std::size_t>> candidates;
  for (std::size_t i = 0; i < first.size(); ++i)
    for (std::size_t k = 0; k < second.size(); ++k)
      if (const std::int64_t apart = std::abs(first[i] - second[k]); apart < most) candidates.emplace_back(apart, i, k);
  std::ranges::sort(candidates);
  std::set<std::pair<std::size_t, std::size_t>> pairs;
  std::set<std::size_t> first_used, second_used;
  for (const auto& [apart, i, k] : candidates) {
    if (first_used.contains(i) || second_used.contains(k)) continue;
    first_used.insert(i);
    second_used.insert(k);
    pairs.emplace(i, k);
  }
  return {pairs.begin(), pairs.end()};
}

TEST(Associate, takes_the_closest_of_all_pairs_first) {
  std::mt19937_64 random(1);
  const auto stamps = [&] {
    std::set<std::int64_t> chosen;
    for (std::uint64_t count = random() % 30; count > 0; --count)
      chosen.insert(static_cast<std::int64_t>(random() % 60));
    return Stamps(chosen.begin(), chosen.end());
  };
  for (int i = 0; i < 2000; ++i) {
    const Stamps first = stamps(), second = stamps();
    const auto most = static_cast<std::int64_t>(random() % 40);
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (const StampPair& pair : associate(first, second, most)) pairs.emplace_back(pair.first, pair.second);
    EXPECT_EQ(pairs, associate_all(first, second, most)) << i;
  }
}

TEST(TumTrajectory, reads_blank_and_comma_separated_rows_and_skips_comments) {
  const Trajectory t = read("# stamp tx ty tz\n\n  # more\n1.5 1 2 3 0 0 0 1\r\n2.5,4,5,+6,0,0,1,0\n");
  ASSERT_EQ(t.size(), 2U);
  EXPECT_EQ(t[0].stamp_ns, 1'500'000'000);
  EXPECT_EQ(t[0].T_world_body.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(t[1].T_world_body.translation(), Eigen::Vector3d(4, 5, 6));
  EXPECT_TRUE(t[1].T_world_body.linear().isApprox(Eigen::Vector3d(-1, -1, 1).asDiagonal().toDenseMatrix(), 1e-12));
}

TEST(TumTrajectory, normalises_a_slightly_long_quaternion) {
  const Trajectory t = read("1 0 0 0 0 0 0.7072 0.7072\n");
  EXPECT_NEAR(t[0].T_world_body.linear().determinant(), 1.0, 1e-12);
  EXPECT_TRUE(t[0].T_world_body.linear().col(0).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
}

TEST(TumTrajectory, repeated_stamp_replaces_the_row_before) {
  const Trajectory t = read("1 1 0 0 0 0 0 1\n1 2 0 0 0 0 0 1\n2 3 0 0 0 0 0 1\n");
  ASSERT_EQ(t.size(), 2U);
  EXPECT_EQ(t[0].T_world_body.translation().x(), 2);
}

struct BadFile {
  const char* name;
  const char* text;
  const char* location;
  const char* cause;
};
class TumTrajectoryRejects : public testing::TestWithParam<BadFile> {};

TEST_P(TumTrajectoryRejects, with_line_and_cause) {
  const std::string error = error_of(GetParam().text);
  EXPECT_THAT(error, testing::HasSubstr(GetParam().location));
  EXPECT_THAT(error, testing::HasSubstr(GetParam().cause));
}

INSTANTIATE_TEST_SUITE_P(
    BadInput, TumTrajectoryRejects,
    testing::Values(BadFile{"few_columns", "# c\n1 0 0 0 0 1\n", "est.txt:2:", "6 columns instead of 8"},
                    BadFile{"many_columns", "1 0 0 0 0 0 0 1 9\n", "est.txt:1:", "9 columns instead of 8"},
                    BadFile{"word", "1 0 zero 0 0 0 0 1\n", "est.txt:1:", "'zero' is not a number"},
                    BadFile{"tail", "1 0 0 0 0 0 0 1x\n", "est.txt:1:", "'1x' is not a number"},
                    BadFile{"long_quaternion", "1 0 0 0 0 0 1 1\n", "est.txt:1:", "quaternion has length 1.41"},
                    BadFile{"zero_quaternion", "1 0 0 0 0 0 0 0\n", "est.txt:1:", "quaternion has length 0.00"},
                    BadFile{"empty", "# nothing\n\n", "est.txt", "holds no poses"}),
    [](const testing::TestParamInfo<BadFile>& bad) { return bad.param.name; });

TEST(TumTrajectory, missing_file_and_folder_are_named) {
  EXPECT_THROW(
      {
        try {
          read_pose_list(std::filesystem::path("/nonexistent/t.txt"));
        } catch (const TrajectoryError& error) {
          EXPECT_THAT(error.what(), testing::HasSubstr("/nonexistent/t.txt cannot be read: No such file"));
          throw;
        }
      },
      TrajectoryError);
  EXPECT_THROW(read_pose_list(std::filesystem::temp_directory_path()), TrajectoryError);
}

TEST(FrameStamps, are_in_the_names_of_a_list_without_stamps) {
  const rtd::test::TemporaryFolder folder;
  const std::string file =
      folder.write("rgb.txt", "\xEF\xBB\xBFrgb/1305031102.175304.png\r\nrgb/1305031102.211214.png\r\n");
  EXPECT_EQ(read_frame_stamps(file), (std::vector<std::int64_t>{1305031102175304000, 1305031102211214000}));
}

}  // namespace
}  // namespace rtd::geometry

namespace rtd::msg {
namespace {

constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min(), kMax = std::numeric_limits<std::int64_t>::max();
constexpr std::array<std::int64_t, 9> kStamps{
    kMin, kMin + 1, -4'000'000'000'000'000'000, -1, 0, 1, 4'000'000'000'000'000'000, kMax - 1, kMax};

TEST(Stamps, ordinary_ones_are_added_and_subtracted) {
  EXPECT_EQ(minus_ns(1'700'000'000'033'333'333, 1'700'000'000'000'000'000), 33'333'333);
  EXPECT_EQ(minus_ns(5, 8), -3);
  EXPECT_EQ(plus_ns(-5, 8), 3);
  EXPECT_EQ(apart_ns(5, 8), 3);
  EXPECT_EQ(apart_ns(8, 5), 3);
  EXPECT_DOUBLE_EQ(minus_s(2'500'000'000, 1'000'000'000), 1.5);
  EXPECT_EQ(ns_of(0.25), 250'000'000);
}

TEST(Stamps, any_two_are_the_nearest_number_apart_that_has_room) {
  EXPECT_EQ(minus_ns(kMax, kMin), kMaxNs);
  EXPECT_EQ(minus_ns(kMin, kMax), -kMaxNs);
  EXPECT_EQ(minus_ns(kMin, 0), -kMaxNs) << "its sign can be changed";
  EXPECT_EQ(minus_ns(0, kMin), kMaxNs);
  EXPECT_EQ(plus_ns(kMax, 1), kMaxNs);
  EXPECT_EQ(plus_ns(kMin, -1), -kMaxNs);
  EXPECT_EQ(plus_ns(kMin, 0), -kMaxNs);
  EXPECT_EQ(apart_ns(kMin, kMax), kMaxNs);
}

TEST(Stamps, differences_keep_the_order) {
  for (const std::int64_t a : kStamps) {
    for (const std::int64_t b : kStamps) {
      EXPECT_EQ(minus_ns(a, b) > 0, a > b) << a << " " << b;
      EXPECT_EQ(minus_ns(a, b), -minus_ns(b, a)) << a << " " << b;
      EXPECT_GE(apart_ns(a, b), 0);
    }
  }
}

TEST(Stamps, seconds_that_have_no_room_are_bounded) {
  EXPECT_GT(ns_of(1e300), 9'000'000'000'000'000'000);
  EXPECT_LT(ns_of(-1e300), -9'000'000'000'000'000'000);
  EXPECT_GT(ns_of(HUGE_VAL), 9'000'000'000'000'000'000);
  EXPECT_EQ(ns_of(std::nan("")), 0);
}

}  // namespace
}  // namespace rtd::msg
