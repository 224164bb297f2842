// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/folder/frame_lists.hpp"

#include <gmock/gmock.h>

#include "tests/unit/camera/sequence_folder.hpp"

namespace rtd::camera {
namespace {

using test::SequenceFolder;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

TEST(ReadPairs, refuses_stamps_that_are_not_finite) {
  for (const char* text : {"nan", "inf", "-inf", "1e300"}) {
    const SequenceFolder folder;
    folder.write("rgb.txt", std::string("1 rgb/a.png\n") + text + " rgb/b.png\n");
    folder.write("depth.txt", "1 depth/a.png\n");
    EXPECT_THAT([&] { read_pairs(folder.path()); }, ThrowsMessage<SourceError>(HasSubstr("rgb.txt:2")));
  }
}

TEST(ReadPairs, refuses_missing_and_empty_folders) {
  EXPECT_THAT([] { read_pairs("/no/such/folder"); }, ThrowsMessage<SourceError>(HasSubstr("does not exist")));
  const SequenceFolder folder;
  EXPECT_THAT([&] { read_pairs(folder.path()); }, ThrowsMessage<SourceError>(HasSubstr("needs rgb.txt")));
}

TEST(ReadPairs, follows_associations_even_when_depth_is_used_twice) {
  const SequenceFolder folder;
  folder.write("associations.txt", "1.0 rgb/a.png 1.01 depth/a.png\r\n1.1 rgb/b.png 1.01 depth/a.png\n");
  const PairList list = read_pairs(folder.path());
  ASSERT_THAT(list.pairs, SizeIs(2));
  EXPECT_EQ(list.pairs[1].depth.file, "depth/a.png");
  EXPECT_EQ(list.pairs[1].color.stamp_ns, 1'100'000'000);
}

TEST(ReadPairs, accepts_associations_that_name_depth_first) {
  const SequenceFolder folder;
  folder.write("associations.txt", "1.0 depth/a.png 1.01 rgb/a.png\n");
  const PairList list = read_pairs(folder.path());
  ASSERT_THAT(list.pairs, SizeIs(1));
  EXPECT_EQ(list.pairs[0].color.file, "rgb/a.png");
  EXPECT_EQ(list.pairs[0].color.stamp_ns, 1'010'000'000);
}

TEST(ReadPairs, reads_byte_order_marks_commas_and_blanks_in_names) {
  const SequenceFolder folder;
  folder.write("rgb.txt",
               "\xEF\xBB\xBF"
               "1.0,rgb/left 1.png\r\n1.1, rgb/left 2.png\r\n");
  folder.write("depth.txt", "1.0 depth/left 1.png\n1.1 depth/left 2.png\n");
  const PairList list = read_pairs(folder.path());
  ASSERT_THAT(list.pairs, SizeIs(2));
  EXPECT_EQ(list.pairs[0].color.file, "rgb/left 1.png");
  EXPECT_EQ(list.pairs[1].color.file, "rgb/left 2.png");
  EXPECT_EQ(list.pairs[1].depth.file, "depth/left 2.png");
  folder.write("associations.txt", "1.0 rgb/left 1.png 1.01 depth/left 1.png\n1.1,rgb/b.png,1.1,depth/b.png\n");
  const PairList associated = read_pairs(folder.path());
  ASSERT_THAT(associated.pairs, SizeIs(2));
  EXPECT_EQ(associated.pairs[0].color.file, "rgb/left 1.png");
  EXPECT_EQ(associated.pairs[0].depth.file, "depth/left 1.png");
  EXPECT_EQ(associated.pairs[1].depth.file, "depth/b.png");
}

TEST(ReadPairs, counts_stamps_that_go_back_or_repeat) {
  const SequenceFolder folder;
  folder.write("rgb.txt", "1.0 a\n1.1 b\n1.1 c\n1.05 d\n1.2 e\n");
  folder.write("depth.txt", "1.0 a\n1.05 b\n1.1 c\n1.2 d\n");
  const PairList list = read_pairs(folder.path());
  ASSERT_THAT(list.pairs, SizeIs(3));
  EXPECT_EQ(list.pairs[2].color.file, "e");
  ASSERT_THAT(list.skipped, SizeIs(2));
  EXPECT_EQ(list.skipped[0].reason, SkipReason::kStampDoubled);
  EXPECT_EQ(list.skipped[1].reason, SkipReason::kStampBackwards);
}

TEST(ReadPairs, counts_frames_without_depth_partner) {
  const SequenceFolder folder;
  folder.write("rgb.txt", "1.0 a\n1.5 b\n");
  folder.write("depth.txt", "1.0 a\n1.6 b\n");
  const PairList list = read_pairs(folder.path());
  EXPECT_THAT(list.pairs, SizeIs(1));
  ASSERT_THAT(list.skipped, SizeIs(1));
  EXPECT_EQ(list.skipped[0].reason, SkipReason::kNoDepthPartner);
}

TEST(ReadPairs, counts_malformed_lines_by_file_and_number) {
  const SequenceFolder folder;
  folder.write("rgb.txt", "# stamps\n1.0 a\nhello world\n1.1\n1.2 b c\n");
  folder.write("depth.txt", "1.0 a\n");
  const PairList list = read_pairs(folder.path());
  EXPECT_THAT(list.pairs, SizeIs(1));
  ASSERT_THAT(list.skipped, SizeIs(3));
  EXPECT_EQ(list.skipped[0].reason, SkipReason::kMalformedLine);
  EXPECT_THAT(list.skipped[0].detail, HasSubstr("rgb.txt:3"));
}

TEST(ReadPairs, refuses_stamps_that_are_not_numbers) {
  const SequenceFolder folder;
  folder.write("rgb.txt", "1.0 a\nnan b\n");
  folder.write("depth.txt", "1.0 a\n");
  EXPECT_THAT([&] { read_pairs(folder.path()); }, ThrowsMessage<SourceError>(HasSubstr("rgb.txt:2")));
}

TEST(ReadPairs, accepts_stamps_hours_apart) {
  const SequenceFolder folder;
  folder.write("rgb.txt", "1.0 a\n20000.0 b\n");
  folder.write("depth.txt", "1.0 a\n20000.0 b\n");
  EXPECT_THAT(read_pairs(folder.path()).pairs, SizeIs(2));
}

}  // namespace
}  // namespace rtd::camera
