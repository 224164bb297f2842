// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "common/camera/folder/folder_source.hpp"
#include "common/camera/folder/frame_lists.hpp"
#include "common/camera/live_uri.hpp"
#include "tests/support/tum_lists.hpp"
#include "tests/unit/camera/played_frames.hpp"
#include "tests/unit/camera/sequence_folder.hpp"

namespace rtd::camera {
namespace {

using test::play_all;
using test::Played;
using test::SequenceFolder;
using test_support::read_tum_lists;
using namespace ::testing;

Played play(const SequenceFolder& folder, const std::string& parameters = "") {
  return play_all(folder.uri() + parameters);
}

class TumSourceTest : public testing::Test {
 protected:
  void SetUp() override { folder.three_frames(); }
  const SequenceFolder folder;
};

TEST_F(TumSourceTest, plays_frames_in_order_with_calibration) {
  const Played played = play(folder);
  ASSERT_THAT(played.frames, SizeIs(3));
  const vision::RgbdImage& image = played.frames[1].image;
  EXPECT_EQ(image.seq, 1U);
  EXPECT_EQ(image.stamp_ns, 1'100'000'000);
  EXPECT_EQ(image.color_bgr.type(), CV_8UC3);
  EXPECT_EQ(image.depth.at<std::uint16_t>(10, 10), 5000);
  EXPECT_DOUBLE_EQ(image.depth_scale_m, 1.0 / 5000);
  EXPECT_DOUBLE_EQ(image.camera.parameters().fy, 53);
  EXPECT_THAT(played.skipped, IsEmpty());
}

TEST_F(TumSourceTest, frames_say_how_far_their_images_are_apart_and_what_the_calibration_says) {
  folder.append("calibration.yaml", "readout_s: 0.02\ndepth_offset_s: 0.001\n");
  folder.write("associations.txt",
               "1.0 rgb/1.0.png 0.987 depth/1.0.png\n1.1 rgb/1.1.png 1.1 depth/1.1.png\n"
               "1.2 rgb/1.2.png 1.5 depth/1.2.png\n");
  const auto source = make_source(folder.uri());
  EXPECT_EQ(source->info().readout_s, 0.02);
  EXPECT_EQ(source->info().depth_offset_s, 0.001);
  const Played played = play(folder);
  ASSERT_THAT(played.frames, SizeIs(3));
  for (const SourceFrame& frame : played.frames) EXPECT_EQ(frame.image.readout_s, 0.02);
  EXPECT_NEAR(played.frames[0].image.depth_offset_s, -0.012, 1e-12) << "depth is 13 ms older, the device adds 1 ms";
  EXPECT_NEAR(played.frames[1].image.depth_offset_s, 0.001, 1e-12);
  EXPECT_EQ(played.frames[2].image.depth_offset_s, 0) << "farther apart than a frame may say: unknown";
}

TEST_F(TumSourceTest, images_of_one_stamp_and_a_plain_calibration_have_no_offset) {
  for (const SourceFrame& frame : play(folder).frames) {
    EXPECT_EQ(frame.image.readout_s, 0);
    EXPECT_EQ(frame.image.depth_offset_s, 0);
  }
}

TEST_F(TumSourceTest, passes_over_old_frames_which_keep_their_seq) {
  test::expect_passes_over_two_of_three(folder.uri());
}

TEST_F(TumSourceTest, images_that_only_the_lists_have_are_no_frames_that_were_passed_over) {
  std::filesystem::remove(folder.path() / "rgb" / "1.1.png");
  const auto source = make_source(folder.uri());
  EXPECT_EQ(source->pass_over(1'150'000'000), 1U) << "as many as next() would have given";
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->image.stamp_ns, 1'200'000'000);
  EXPECT_EQ(frame->image.seq, 1U);
  EXPECT_EQ(source->counters().of(SkipReason::kColorUnreadable), 1U);
}

TEST(TumSource, reads_jpeg_colour) {
  const SequenceFolder folder;
  folder.write("calibration.yaml", SequenceFolder::calibration());
  folder.image("rgb/a.jpg", SequenceFolder::color());
  folder.image("depth/a.png", SequenceFolder::depth());
  folder.write("associations.txt", "1 rgb/a.jpg 1 depth/a.png\n");
  EXPECT_THAT(play(folder).frames, SizeIs(1));
}

TEST_F(TumSourceTest, reads_masks_on_request) {
  std::filesystem::create_directories(folder.path() / "mask");
  cv::Mat mask(SequenceFolder::kHeight, SequenceFolder::kWidth, CV_8UC1, cv::Scalar(0));
  mask.at<std::uint8_t>(5, 6) = 1;
  folder.image("mask/1.0.png", mask);
  const Played played = play(folder, "?masks=1");
  EXPECT_EQ(played.frames[0].dynamic_mask.at<std::uint8_t>(5, 6), 255);
  EXPECT_EQ(cv::countNonZero(played.frames[0].dynamic_mask), 1);
  EXPECT_TRUE(played.frames[1].dynamic_mask.empty());
  EXPECT_TRUE(play(folder).frames[0].dynamic_mask.empty());
}

TEST_F(TumSourceTest, skips_missing_and_truncated_images_and_continues) {
  for (const char* stamp : {"1.3", "1.4", "1.5", "1.6"}) folder.frame(stamp);
  std::filesystem::remove(folder.path() / "rgb/1.1.png");
  folder.truncate("rgb/1.2.png");
  folder.truncate("depth/1.3.png");
  folder.write("rgb/1.4.png", "");
  folder.write("rgb/1.5.png", "this is no image");
  const Played played = play(folder);
  ASSERT_THAT(played.frames, SizeIs(2));
  EXPECT_EQ(played.frames[1].image.seq, 1U) << "no gap in seq";
  EXPECT_EQ(played.frames[1].image.stamp_ns, 1'600'000'000);
  EXPECT_EQ(played.counters.of(SkipReason::kColorUnreadable), 4U);
  EXPECT_EQ(played.counters.of(SkipReason::kDepthUnreadable), 1U);
  EXPECT_THAT(played.skipped[0].detail, AllOf(HasSubstr("1.1.png"), HasSubstr("cannot be read")));
  EXPECT_THAT(played.skipped[1].detail, HasSubstr("truncated"));
}

TEST_F(TumSourceTest, skips_truncated_jpeg_instead_of_grey_filling) {
  folder.image("rgb/b.jpg", SequenceFolder::color());
  folder.truncate("rgb/b.jpg");
  folder.write("associations.txt", "1.0 rgb/1.0.png 1.0 depth/1.0.png\n1.1 rgb/b.jpg 1.1 depth/1.1.png\n");
  const Played played = play(folder);
  EXPECT_THAT(played.frames, SizeIs(1));
  EXPECT_EQ(played.counters.of(SkipReason::kColorUnreadable), 1U);
}

TEST_F(TumSourceTest, names_the_pixel_type_of_depth_that_is_not_16_bit) {
  folder.image("depth/1.1.png", cv::Mat(SequenceFolder::kHeight, SequenceFolder::kWidth, CV_8UC1, cv::Scalar(9)));
  folder.image("depth/c.png", cv::Mat(SequenceFolder::kHeight, SequenceFolder::kWidth, CV_16UC3, cv::Scalar(9, 9, 9)));
  folder.append("rgb.txt", "1.3 rgb/1.0.png\n");
  folder.append("depth.txt", "1.3 depth/c.png\n");
  const Played played = play(folder);
  EXPECT_THAT(played.frames, SizeIs(2));
  EXPECT_EQ(played.counters.of(SkipReason::kDepthNot16Bit), 2U);
  EXPECT_THAT(played.skipped[0].detail, AllOf(HasSubstr("8-bit"), HasSubstr("needed is a 16-bit")));
  EXPECT_THAT(played.skipped[1].detail, HasSubstr("16-bit, 3 channels"));
}

TEST_F(TumSourceTest, names_the_formats_it_reads) {
  folder.image("depth/f.tiff", cv::Mat(SequenceFolder::kHeight, SequenceFolder::kWidth, CV_32FC1, cv::Scalar(1.5)));
  folder.append("rgb.txt", "1.3 rgb/1.0.png\n");
  folder.append("depth.txt", "1.3 depth/f.tiff\n");
  folder.write("depth/g.bmp", "BM");
  folder.append("rgb.txt", "1.4 rgb/1.0.png\n");
  folder.append("depth.txt", "1.4 depth/g.bmp\n");
  const Played played = play(folder);
  ASSERT_THAT(played.frames, SizeIs(4));
  EXPECT_EQ(played.frames[3].image.depth.at<std::uint16_t>(0, 0), 7500) << "1.5 m";
  EXPECT_EQ(played.counters.of(SkipReason::kDepthUnreadable), 1U);
  EXPECT_THAT(played.skipped[0].detail, AllOf(HasSubstr("g.bmp"), HasSubstr("readable: 16-bit PNG, PGM, TIFF")));
}

TEST(TumSource, refuses_a_sequence_without_one_good_frame) {
  const SequenceFolder folder;
  folder.write("calibration.yaml", SequenceFolder::calibration());
  for (const char* stamp : {"1.0", "1.1"}) {
    folder.frame(stamp, cv::Mat(SequenceFolder::kHeight, SequenceFolder::kWidth, CV_8UC1, cv::Scalar(9)));
  }
  EXPECT_TRUE(test::refuses(folder.uri(), {"2 x depth_not_16_bit", "16-bit"}));
}

TEST(TumSource, refuses_empty_lists) {
  const SequenceFolder folder;
  folder.write("calibration.yaml", SequenceFolder::calibration());
  folder.write("rgb.txt", "# nothing\n");
  folder.write("depth.txt", "");
  EXPECT_TRUE(test::refuses(folder.uri(), {"lists are empty"}));
}

TEST_F(TumSourceTest, passes_frames_without_any_depth_and_counts_them) {
  folder.frame("1.3", SequenceFolder::depth(0));
  const Played played = play(folder);
  ASSERT_THAT(played.frames, SizeIs(4));
  EXPECT_FALSE(played.frames[3].has_depth);
  EXPECT_TRUE(played.frames[0].has_depth);
  EXPECT_EQ(played.counters.frames_without_depth, 1U);
}

TEST_F(TumSourceTest, treats_saturated_depth_as_missing) {
  cv::Mat depth = SequenceFolder::depth();
  depth.at<std::uint16_t>(3, 4) = 65535;
  depth.at<std::uint16_t>(3, 5) = 65534;
  folder.frame("1.3", depth);
  const Played played = play(folder);
  EXPECT_EQ(played.frames[3].image.depth.at<std::uint16_t>(3, 4), 0);
  EXPECT_EQ(played.frames[3].image.depth.at<std::uint16_t>(3, 5), 65534);
}

TEST(TumSource, refuses_frames_larger_than_the_frame_type) {
  const SequenceFolder folder;
  folder.write("calibration.yaml", SequenceFolder::calibration());
  folder.image("rgb/a.png", SequenceFolder::color(1600, 1600));
  folder.image("depth/a.png", SequenceFolder::depth());
  folder.write("associations.txt", "1 rgb/a.png 1 depth/a.png\n");
  EXPECT_TRUE(test::refuses(folder.uri(), {"1600 x 1600", "at most 1920 x 1200"}));
}

TEST_F(TumSourceTest, skips_frames_of_another_size_than_calibrated) {
  folder.image("rgb/1.1.png", SequenceFolder::color(32, 32));
  const Played played = play(folder);
  EXPECT_THAT(played.frames, SizeIs(2));
  EXPECT_EQ(played.counters.of(SkipReason::kSizeMismatch), 1U);
}

TEST_F(TumSourceTest, gives_groundtruth_of_its_span_only) {
  folder.write("groundtruth.txt", "0.4 0 0 0 0 0 0 1\n0.6 1 0 0 0 0 0 1\n1.6 2 0 0 0 0 0 1\n1.8 3 0 0 0 0 0 1\n");
  const auto poses = make_source(folder.uri())->groundtruth();
  ASSERT_THAT(poses, SizeIs(2));
  EXPECT_EQ(poses[0].T_world_body.translation().x(), 1);
  EXPECT_EQ(poses[1].T_world_body.translation().x(), 2);
}

TEST_F(TumSourceTest, knows_the_true_pose_between_two_that_are_near) {
  folder.write("groundtruth.txt", "1.00 1 0 0 0 0 0 1\n1.02 3 0 0 0 0 0 1\n1.2 9 0 0 0 0 0 1\n");
  const auto source = make_source(folder.uri());
  EXPECT_NEAR(source->true_pose(1'005'000'000).value().translation().x(), 1.5, 1e-9);
  EXPECT_NEAR(source->true_pose(1'200'000'000).value().translation().x(), 9, 1e-9);
  EXPECT_FALSE(source->true_pose(1'100'000'000)) << "100 ms from the next";
  EXPECT_FALSE(source->true_pose(900'000'000));
}

TEST_F(TumSourceTest, plays_whatever_the_groundtruth_is_and_says_what_is_not_used) {
  folder.write("groundtruth.txt", "timestamp tx ty tz qx qy qz qw\n1.0 0 0 0 0 0 0 1\n1.1 nan 0 0 0 0 0 1\n");
  auto source = make_source(folder.uri());
  EXPECT_THAT(source->groundtruth(), SizeIs(1));
  EXPECT_THAT(source->info().remarks, ElementsAre(HasSubstr("1 title line"), HasSubstr("1 row of nan left out")));
  folder.write("groundtruth.txt", "1.0 0 0 0 90 45 10\n");
  source = make_source(folder.uri());
  EXPECT_THAT(source->groundtruth(), SizeIs(0));
  EXPECT_THAT(source->info().remarks,
              ElementsAre(AllOf(HasSubstr("ground truth not used: "), HasSubstr("groundtruth.txt:1: 7 columns"))));
  folder.write("groundtruth.txt", "100001000 0 0 0 0 0 0 1\n");
  EXPECT_THAT(make_source(folder.uri())->info().remarks, ElementsAre(HasSubstr("no pose at the time of the frames")));
}

TEST_F(TumSourceTest, plays_with_the_good_rows_of_broken_groundtruth_and_counts_the_others) {
  folder.write("groundtruth.txt",
               "timestamp tx ty tz qx qy qz qw\n1.0 0 0 0 0 0 0 1\n1.1 0 0 broken 0 0 0 1\n1.2 1 0 0 0 0 0 1\n");
  const auto source = make_source(folder.uri());
  EXPECT_THAT(source->groundtruth(), SizeIs(2));
  EXPECT_THAT(source->info().notes, testing::Contains(HasSubstr("2 poses of groundtruth.txt; 2 belong")));
  EXPECT_THAT(source->info().remarks, testing::Contains(AllOf(HasSubstr("1 row that cannot be read, first: "),
                                                              HasSubstr("groundtruth.txt:3: 'broken'"))));
}

TEST(MakeSource, names_the_schemes_it_knows) {
  EXPECT_TRUE(test::refuses("folder", {"tum:FOLDER"}));
  EXPECT_TRUE(
      test::refuses("rosbag:x", {"known: bag, db3, folder, mcap, openni2, realsense-dds, ros2, synthetic, tum"}));
  for (const char* video_nodes : {"v4l2:", "v4l2:/dev/video0,/dev/video2?calibration=c.yaml"}) {
    EXPECT_FALSE(is_live(video_nodes));
    EXPECT_TRUE(test::refuses(video_nodes, {"registered to colour", "openni2:, realsense-dds:", "ros2:COLOR,DEPTH"}));
  }
  EXPECT_TRUE(test::refuses("tum:", {"needs a folder"}));
  EXPECT_TRUE(test::refuses("tum:x?mask=1", {"unknown parameter 'mask'"}));
  EXPECT_TRUE(test::refuses("tum:x?masks", {"not key=value"}));
}

TEST(TumLists, refuses_stamps_that_are_not_finite) {
  for (const char* text : {"nan", "inf", "-inf", "1e300"}) {
    const SequenceFolder folder;
    folder.write("rgb.txt", std::string("1 rgb/a.png\n") + text + " rgb/b.png\n");
    folder.write("depth.txt", "1 depth/a.png\n");
    EXPECT_THAT([&] { read_tum_lists(folder.path()); }, ThrowsMessage<SourceError>(HasSubstr("rgb.txt:2")));
  }
}

TEST(TumLists, follows_associations_even_when_depth_is_used_twice) {
  const SequenceFolder folder;
  folder.write("associations.txt", "1.0 rgb/a.png 1.01 depth/a.png\r\n1.1 rgb/b.png 1.01 depth/a.png\n");
  const PairList list = read_tum_lists(folder.path());
  ASSERT_THAT(list.pairs, SizeIs(2));
  EXPECT_EQ(list.pairs[1].depth.file, "depth/a.png");
  EXPECT_EQ(list.pairs[1].color.stamp_ns, 1'100'000'000);
}

TEST(TumLists, accepts_associations_that_name_depth_first) {
  const SequenceFolder folder;
  folder.write("associations.txt", "1.0 depth/a.png 1.01 rgb/a.png\n");
  const PairList list = read_tum_lists(folder.path());
  ASSERT_THAT(list.pairs, SizeIs(1));
  EXPECT_EQ(list.pairs[0].color.file, "rgb/a.png");
  EXPECT_EQ(list.pairs[0].color.stamp_ns, 1'010'000'000);
}

TEST(TumLists, reads_byte_order_marks_commas_and_blanks_in_names) {
  const SequenceFolder folder;
  folder.write("rgb.txt",
               "\xEF\xBB\xBF"
               "1.0,rgb/left 1.png\r\n1.1, rgb/left 2.png\r\n");
  folder.write("depth.txt", "1.0 depth/left 1.png\n1.1 depth/left 2.png\n");
  const PairList list = read_tum_lists(folder.path());
  ASSERT_THAT(list.pairs, SizeIs(2));
  EXPECT_EQ(list.pairs[0].color.file, "rgb/left 1.png");
  EXPECT_EQ(list.pairs[1].color.file, "rgb/left 2.png");
  EXPECT_EQ(list.pairs[1].depth.file, "depth/left 2.png");
  folder.write("associations.txt", "1.0 rgb/left 1.png 1.01 depth/left 1.png\n1.1,rgb/b.png,1.1,depth/b.png\n");
  const PairList associated = read_tum_lists(folder.path());
  ASSERT_THAT(associated.pairs, SizeIs(2));
  EXPECT_EQ(associated.pairs[0].color.file, "rgb/left 1.png");
  EXPECT_EQ(associated.pairs[0].depth.file, "depth/left 1.png");
  EXPECT_EQ(associated.pairs[1].depth.file, "depth/b.png");
}

TEST(TumLists, counts_stamps_that_go_back_or_repeat) {
  const SequenceFolder folder;
  folder.write("rgb.txt", "1.0 a\n1.1 b\n1.1 c\n1.05 d\n1.2 e\n");
  folder.write("depth.txt", "1.0 a\n1.05 b\n1.1 c\n1.2 d\n");
  const PairList list = read_tum_lists(folder.path());
  ASSERT_THAT(list.pairs, SizeIs(3));
  EXPECT_EQ(list.pairs[2].color.file, "e");
  ASSERT_THAT(list.skipped, SizeIs(2));
  EXPECT_EQ(list.skipped[0].reason, SkipReason::kStampDoubled);
  EXPECT_EQ(list.skipped[1].reason, SkipReason::kStampBackwards);
}

TEST(TumLists, counts_frames_without_depth_partner) {
  const SequenceFolder folder;
  folder.write("rgb.txt", "1.0 a\n1.5 b\n");
  folder.write("depth.txt", "1.0 a\n1.6 b\n");
  const PairList list = read_tum_lists(folder.path());
  EXPECT_THAT(list.pairs, SizeIs(1));
  ASSERT_THAT(list.skipped, SizeIs(1));
  EXPECT_EQ(list.skipped[0].reason, SkipReason::kNoDepthPartner);
}

TEST(TumLists, counts_malformed_lines_by_file_and_number) {
  const SequenceFolder folder;
  folder.write("rgb.txt", "# stamps\n1.0 a\nhello world\n1.1\n1.2 b c\n");
  folder.write("depth.txt", "1.0 a\n");
  const PairList list = read_tum_lists(folder.path());
  EXPECT_THAT(list.pairs, SizeIs(1));
  ASSERT_THAT(list.skipped, SizeIs(3));
  EXPECT_EQ(list.skipped[0].reason, SkipReason::kMalformedLine);
  EXPECT_THAT(list.skipped[0].detail, HasSubstr("rgb.txt:3"));
}

TEST(TumLists, refuses_stamps_that_are_not_numbers) {
  const SequenceFolder folder;
  folder.write("rgb.txt", "1.0 a\nnan b\n");
  folder.write("depth.txt", "1.0 a\n");
  EXPECT_THAT([&] { read_tum_lists(folder.path()); }, ThrowsMessage<SourceError>(HasSubstr("rgb.txt:2")));
}

TEST(TumLists, accepts_stamps_hours_apart) {
  const SequenceFolder folder;
  folder.write("rgb.txt", "1.0 a\n20000.0 b\n");
  folder.write("depth.txt", "1.0 a\n20000.0 b\n");
  EXPECT_THAT(read_tum_lists(folder.path()).pairs, SizeIs(2));
}

}  // namespace
}  // namespace rtd::camera
