// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/pose_list.hpp"

#include <gmock/gmock.h>

namespace rtd::geometry {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::ThrowsMessage;

PoseList read_text_of(const std::string& text) {
  return read_pose_list(text, "truth.txt");
}

std::string rising_rows(int first, int count, const std::string& unit = ".5") {
  std::string text;
  for (int i = first; i < first + count; ++i)
    text += std::to_string(i) + unit + " " + std::to_string(i) + " 0 0 0 0 0 1\n";
  return text;
}

TEST(PoseList, leaves_out_and_counts_a_title_and_rows_of_nan) {
  const PoseList list = read_text_of(
      "timestamp tx ty tz qx qy qz qw\n100.0 1.3 0.6 1.6 0 0 0 1\n100.1 nan nan nan nan nan nan nan\n"
      "100.2 1.3 0.6 1.6 0 0 0 1\n");
  EXPECT_THAT(stamps_of(list.poses), ElementsAre(100'000'000'000, 100'200'000'000));
  EXPECT_THAT(list.notes,
              ElementsAre("truth.txt: 1 title line without '#' left out", "truth.txt: 1 row of nan left out"));
  EXPECT_THAT(list.damages, IsEmpty());
}

TEST(PoseList, reads_stamps_in_other_units) {
  const std::string pose = " 1 2 3 0 0 0 1\n";
  const PoseList orb_slam3 =
      read_text_of("1403636579763555584.000000" + pose + "1403636579813555456.000000" + pose);  // as it saves for EuRoC
  EXPECT_THAT(stamps_of(orb_slam3.poses), ElementsAre(1403636579763555584, 1403636579813555456));
  EXPECT_THAT(orb_slam3.notes, ElementsAre("truth.txt: its stamps are in ns"));
  EXPECT_EQ(read_text_of("1403636579763555" + pose + "1403636579813555.4" + pose).poses[1].stamp_ns,
            1403636579813555400);
  EXPECT_EQ(read_text_of("1403636579763" + pose + "1403636579813" + pose).poses[0].stamp_ns, 1403636579763000000);
  EXPECT_EQ(read_text_of("50000000000" + pose + "50033000000" + pose).poses[0].stamp_ns, 50'000'000'000)
      << "since the start";
  EXPECT_EQ(read_text_of("1.40363657976355e+18" + pose).poses[0].stamp_ns / 1'000'000'000, 1403636579);
}

TEST(PoseList, reads_the_forms_of_others) {
  const auto x_of = [](const std::string& text) {
    return read_text_of(text).poses.at(0).T_world_body.translation().x();
  };
  EXPECT_EQ(x_of("\xEF\xBB\xBF"
                 "1.5,7,0,0,0,0,0,1\r\n"),
            7)
      << "byte order mark, commas, CRLF";
  EXPECT_EQ(x_of("1.5; 7; 0; 0; 0; 0; 0; 1\n"), 7);
  EXPECT_EQ(x_of("1.5 1 0 0 7 0 1 0 0 0 0 1 0\n"), 7) << "stamp and 3 x 4";
  EXPECT_EQ(x_of("1.5 1 0 0 7 0 1 0 0 0 0 1 0 0 0 0 1\n"), 7) << "stamp and 4 x 4";
  EXPECT_EQ(x_of("1.5 rgb/1.5.png 1.5 depth/1.5.png 1.5 7 0 0 0 0 0 1\n"), 7) << "associations with ground truth";
  EXPECT_EQ(read_text_of("rgb/12.250000.png 7 0 0 0 0 0 1\n").poses.at(0).stamp_ns, 12'250'000'000)
      << "stamp in a name";
}

TEST(PoseList, counts_poses_without_stamps_and_gives_them_those_of_their_places) {
  const std::string row = "1 0 0 7 0 1 0 0 0 0 1 0\n", matrix = "1 0 0 7\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  for (const std::string& text :
       {row + "1 0 0 nan 0 1 0 0 0 0 1 0\n" + row,
        "0\t0\t1\n" + matrix + "1 1 2\n" + "inf " + matrix.substr(2) + matrix,
        std::string("7 0 0 0 0 0 1\nnan 0 0 0 0 0 1\n7 0 0 0 0 0 1\n"),
        "[[" + row.substr(0, 8) + "]\n[0 1 0 0]\n[0 0 1 0]\n[0 0 0 1]]\ninf" + matrix.substr(1) + matrix}) {
    PoseList list = read_text_of(text);
    EXPECT_EQ(list.places, 3U) << text;
    EXPECT_THAT(list.notes, ElementsAre("truth.txt: 1 row of nan left out"));
    EXPECT_FALSE(give_stamps(list, {10, 20}));
    ASSERT_TRUE(give_stamps(list, {10, 20, 30})) << text;
    EXPECT_THAT(stamps_of(list.poses), ElementsAre(10, 30)) << text;
    EXPECT_EQ(list.poses[1].T_world_body.translation().x(), 7) << text;
  }
}

TEST(PoseList, takes_the_longest_segment_where_stamps_go_back) {
  const PoseList twice = read_text_of(rising_rows(0, 8) + rising_rows(0, 12));
  EXPECT_THAT(twice.poses, SizeIs(12));
  EXPECT_THAT(twice.notes,
              ElementsAre("truth.txt: stamps go back: 2 segments, the longest, number 2 with 12 of 20 poses, is used"));
  const PoseList shuffled = read_text_of(rising_rows(5, 1) + rising_rows(3, 1) + rising_rows(4, 1) + rising_rows(1, 1));
  EXPECT_THAT(stamps_of(shuffled.poses), ElementsAre(1'500'000'000, 3'500'000'000, 4'500'000'000, 5'500'000'000));
  EXPECT_THAT(shuffled.notes, ElementsAre(HasSubstr("not in the order of their stamps: sorted")));
}

TEST(PoseList, names_a_few_broken_rows_and_refuses_more) {
  const PoseList list = read_text_of(rising_rows(0, 5) + "9 9 9\n");
  EXPECT_THAT(list.poses, SizeIs(5));
  EXPECT_THAT(
      list.damages,
      ElementsAre(
          "1 row that cannot be read, first: truth.txt:6: 3 columns instead of 8 (stamp tx ty tz qx qy qz qw)"));
  EXPECT_THAT([] { read_text_of("1 0 0 0 0 0 0 1\n2 0 0\n"); },
              ThrowsMessage<TrajectoryError>(AllOf(HasSubstr("truth.txt:2"), HasSubstr("3 columns instead of 8"))));
  EXPECT_THAT([] { read_text_of("1 0 0 0 0 0 1 1\n"); },
              ThrowsMessage<TrajectoryError>(HasSubstr("quaternion has length 1.41")));
  EXPECT_THAT([] { read_text_of("1 nan 0 0 0 0 0 1\n"); }, ThrowsMessage<TrajectoryError>(HasSubstr("holds no poses")));
  EXPECT_THAT([] { read_text_of("# nothing\n\n"); }, ThrowsMessage<TrajectoryError>(HasSubstr("holds no poses")));
  EXPECT_THAT([] { read_pose_list(std::filesystem::path("/no/such.txt")); },
              ThrowsMessage<TrajectoryError>(HasSubstr("No such file")));
}

}  // namespace
}  // namespace rtd::geometry
