// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/trajectory.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

namespace rtd::eval {
namespace {

Trajectory read(const std::string& text) {
  std::istringstream input(text);
  return read_tum_trajectory(input, "est.txt");
}

std::string error_of(const std::string& text) {
  try {
    read(text);
  } catch (const TrajectoryError& error) {
    return error.what();
  }
  return "no error";
}

TEST(TumTrajectory, reads_blank_and_comma_separated_rows_and_skips_comments) {
  const Trajectory t = read("# stamp tx ty tz\n\n  # more\n1.5 1 2 3 0 0 0 1\r\n2.5,4,5,+6,0,0,1,0\n");
  ASSERT_EQ(t.size(), 2U);
  EXPECT_EQ(t[0].stamp_ns, 1'500'000'000);
  EXPECT_EQ(t[0].T_world_body.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(t[1].T_world_body.translation(), Eigen::Vector3d(4, 5, 6));
  EXPECT_TRUE(t[1].T_world_body.linear().isApprox(Eigen::Vector3d(-1, -1, 1).asDiagonal().toDenseMatrix(), 1e-12));
}

TEST(TumTrajectory, keeps_every_digit_of_a_unix_stamp) {
  EXPECT_EQ(parse_stamp_ns("1341846313.6541841"), 1341846313654184100);
  EXPECT_EQ(parse_stamp_ns("1341846313.123456789"), 1341846313123456789);
  EXPECT_EQ(parse_stamp_ns("7"), 7'000'000'000);
  EXPECT_EQ(parse_stamp_ns(".5"), 500'000'000);
  EXPECT_EQ(parse_stamp_ns("-1.5"), -1'500'000'000);
  EXPECT_EQ(parse_stamp_ns("1.5e3"), 1'500'000'000'000);
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
    testing::Values(
        BadFile{"nan", "1 0 0 0 0 0 0 1\n2 nan 0 0 0 0 0 1\n", "est.txt:2:", "not a finite number"},
        BadFile{"infinite", "1 inf 0 0 0 0 0 1\n", "est.txt:1:", "not a finite number"},
        BadFile{"few_columns", "# c\n1 0 0 0 0 0 1\n", "est.txt:2:", "7 columns instead of 8"},
        BadFile{"many_columns", "1 0 0 0 0 0 0 1 9\n", "est.txt:1:", "9 columns instead of 8"},
        BadFile{"word", "1 0 zero 0 0 0 0 1\n", "est.txt:1:", "'zero' is not a number"},
        BadFile{"tail", "1 0 0 0 0 0 0 1x\n", "est.txt:1:", "'1x' is not a number"},
        BadFile{"long_quaternion", "1 0 0 0 0 0 1 1\n", "est.txt:1:", "quaternion has length 1.41"},
        BadFile{"zero_quaternion", "1 0 0 0 0 0 0 0\n", "est.txt:1:", "quaternion has length 0.00"},
        BadFile{"backwards", "2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", "est.txt:2:", "earlier than the one before"},
        BadFile{"nanoseconds", "1341846313654184100 0 0 0 0 0 0 1\n", "est.txt:1:", "seconds, not nanoseconds"},
        BadFile{"empty", "# nothing\n\n", "est.txt", "holds no poses"}),
    [](const testing::TestParamInfo<BadFile>& bad) { return bad.param.name; });

TEST(TumTrajectory, missing_file_and_folder_are_named) {
  EXPECT_THROW(
      {
        try {
          read_tum_trajectory(std::filesystem::path("/nonexistent/t.txt"));
        } catch (const TrajectoryError& error) {
          EXPECT_THAT(error.what(), testing::HasSubstr("/nonexistent/t.txt: no such file"));
          throw;
        }
      },
      TrajectoryError);
  EXPECT_THROW(read_tum_trajectory(std::filesystem::temp_directory_path()), TrajectoryError);
}

}  // namespace
}  // namespace rtd::eval
