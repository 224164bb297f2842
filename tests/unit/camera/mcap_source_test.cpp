// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "common/camera/recording/recording.hpp"
#include "services/recorder/mcap_export.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/camera/mcap_file.hpp"
#include "tests/unit/camera/played_frames.hpp"
#include "tests/unit/camera/sequence_folder.hpp"

namespace rtd::camera {
namespace {

using test::ImageBag;
using test::McapFile;
using test::own_frame;
using test::play_all;
using test::Played;
using test::SequenceFolder;
using namespace ::testing;

constexpr const char* kImage = "sensor_msgs/msg/Image";
constexpr const char* kCompressed = "sensor_msgs/msg/CompressedImage";

class DepthFactors : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(All, DepthFactors, testing::Values(5000, 1000, 5208));

TEST_P(DepthFactors, what_is_exported_comes_back_pixel_by_pixel) {
  const SequenceFolder folder;
  std::string calibration = SequenceFolder::calibration() + "k1: 0.1\np2: -0.002\nk3: 0.3\n";
  calibration.replace(calibration.find("5000"), 4, std::to_string(GetParam()));
  folder.write("calibration.yaml", calibration);
  for (const char* stamp : {"1.000001", "1.1", "1.2"}) {
    cv::Mat depth(SequenceFolder::kHeight, SequenceFolder::kWidth, CV_16UC1);
    cv::randu(depth, 0, 65535);
    depth(cv::Rect(3, 4, 5, 6)) = 0;
    folder.frame(stamp, depth);
  }
  folder.write("groundtruth.txt", "0.9 1 2 3 0.5 -0.5 0.5 0.5\n1.15 4 5 6 0 0 0 1\n");
  const auto file = folder.path() / "out.mcap";
  std::vector<std::uint64_t> counts;
  const auto source = make_source(folder.uri());
  EXPECT_EQ(recordings::export_mcap(*source, file, mcap::Compression::kZstd, 0, [&](auto n) { counts.push_back(n); }),
            3U);
  EXPECT_THAT(counts, testing::ElementsAre(1U, 2U, 3U));

  const Played before = play_all(folder.uri()), after = play_all("mcap:" + file.string());
  ASSERT_THAT(after.frames, SizeIs(3));
  EXPECT_THAT(after.skipped, IsEmpty());
  for (std::size_t i = 0; i < 3; ++i) {
    const vision::RgbdImage &a = before.frames[i].image, &b = after.frames[i].image;
    EXPECT_EQ(b.stamp_ns, a.stamp_ns);
    EXPECT_TRUE(test::same(a.color_bgr, b.color_bgr));
    EXPECT_TRUE(test::same(a.depth, b.depth));
    EXPECT_NEAR(1 / b.depth_scale_m, GetParam(), 1e-6);
    EXPECT_EQ(b.camera.parameters().distortion, a.camera.parameters().distortion);
    EXPECT_EQ(b.camera.parameters().cx, a.camera.parameters().cx);
  }
  const auto played = make_source("mcap:" + file.string());
  while (played->next()) continue;
  const auto poses = played->groundtruth();
  ASSERT_THAT(poses, SizeIs(2));
  EXPECT_EQ(poses[0].stamp_ns, 900'000'000);
  EXPECT_TRUE(poses[0].T_world_body.isApprox(source->groundtruth()[0].T_world_body, 1e-12));
}

TEST(McapExport, leaves_an_existing_file_alone) {
  const SequenceFolder folder;
  folder.three_frames();
  folder.write("out.mcap", "precious");
  const auto source = make_source(folder.uri());
  EXPECT_THAT([&] { recordings::export_mcap(*source, folder.path() / "out.mcap", mcap::Compression::kNone, 0); },
              ThrowsMessage<SourceError>(HasSubstr("out.mcap exists")));
  EXPECT_EQ(std::filesystem::file_size(folder.path() / "out.mcap"), 8U);
}

TEST(McapSource, plays_what_ros2_records) {
  McapFile file;
  msg::CompressedImage color, depth;
  color.header = depth.header = {msg::to_time(1'000'000'000), "camera_color_optical_frame"};
  color.format = "rgb8; png compressed bgr8";
  cv::imencode(".png", ImageBag::color(), color.data);
  depth.format = "16UC1; compressedDepth png";
  cv::imencode(".png", ImageBag::depth(), depth.data);
  depth.data.insert(depth.data.begin(), 12, 0);
  file.add("/camera/camera/color/image_raw/compressed", kCompressed, color, 1.01);
  file.add("/camera/camera/aligned_depth_to_color/image_raw/compressedDepth", kCompressed, depth, 1.05);
  file.add("/camera/camera/color/camera_info", "sensor_msgs/msg/CameraInfo", ImageBag::camera_info(), 1.02);
  const Played played = play_all(file.uri());
  ASSERT_THAT(played.frames, SizeIs(1));
  EXPECT_EQ(played.frames[0].image.stamp_ns, 1'000'000'000);
  EXPECT_TRUE(test::same(played.frames[0].image.color_bgr, ImageBag::color()));
  EXPECT_TRUE(test::same(played.frames[0].image.depth, ImageBag::depth()));
}

TEST(McapSource, plays_bags_that_were_converted_to_mcap) {
  McapFile file;
  const auto add = [&](const char* topic, const char* type, const auto& message) {
    file.add(topic, type, "ros1", ros::encode<ros::Wire::kRos1>(message), 1);
  };
  add(ImageBag::kColor, "sensor_msgs/Image", ImageBag::image(ImageBag::color(), "bgr8", 1));
  add(ImageBag::kDepth, "sensor_msgs/Image", ImageBag::image(ImageBag::depth(), "16UC1", 1));
  add(ImageBag::kInfo, "sensor_msgs/CameraInfo", ImageBag::camera_info());
  EXPECT_THAT(play_all(file.uri()).frames, SizeIs(1));
}

TEST(McapSource, a_file_without_summary_and_chunks_is_whole) {
  mcap::WriterOptions options;
  options.use_chunks = options.use_chunk_index = options.use_message_index = options.use_statistics = false;
  options.use_repeated_schemas = options.use_repeated_channels = options.use_summary_offset = false;
  McapFile file(options);
  file.add("/camera/color/image_raw", kImage, ImageBag::image(ImageBag::color(), "bgr8", 1), 1);
  file.add("/camera/aligned_depth_to_color/image_raw", kImage, ImageBag::image(ImageBag::depth(), "16UC1", 1), 1);
  file.add("/camera/color/camera_info", "sensor_msgs/msg/CameraInfo", ImageBag::camera_info(), 1);
  const Played played = play_all(file.uri());
  EXPECT_THAT(played.frames, SizeIs(1));
  EXPECT_THAT(played.skipped, IsEmpty());
}

TEST(McapSource, wants_depth_registered_to_colour) {
  McapFile file;
  msg::Image depth = ImageBag::image(ImageBag::depth(), "16UC1", 1);
  depth.header.frame_id = "camera_depth_optical_frame";
  file.add("/camera/color/image_raw", kImage, ImageBag::image(ImageBag::color(), "bgr8", 1), 1);
  file.add("/camera/depth/image_rect_raw", kImage, depth, 1);
  file.add("/camera/color/camera_info", "sensor_msgs/msg/CameraInfo", ImageBag::camera_info(), 1);
  const std::string uri = file.uri();
  EXPECT_TRUE(test::refuses(uri, {"registered to colour", "camera_depth_optical"}));
  const std::string named = uri + "?depth=/camera/depth/image_rect_raw";
  EXPECT_TRUE(test::refuses(named, {"?registered=1"}));
  EXPECT_THAT(play_all(named + "&registered=1").frames, SizeIs(1));
}

TEST(McapSource, plays_dense_images_whose_step_is_0_and_remarks_it_once) {
  McapFile file;
  file.add(ImageBag::kInfo, "sensor_msgs/msg/CameraInfo", ImageBag::camera_info(), 0.9);
  for (const double stamp_s : {1.0, 1.1}) {
    msg::Image color = ImageBag::image(ImageBag::color(), "bgr8", stamp_s);
    color.step = 0;
    file.add(ImageBag::kColor, "sensor_msgs/msg/Image", color, stamp_s);
    file.add(ImageBag::kDepth, "sensor_msgs/msg/Image", ImageBag::image(ImageBag::depth(), "16UC1", stamp_s), stamp_s);
  }
  const auto source = make_source(file.uri());
  EXPECT_EQ(source->info().remarks.size(), 1U);
  EXPECT_THAT(source->info().remarks.front(), HasSubstr("'step' is 0"));
  int frames = 0;
  while (source->next()) ++frames;
  EXPECT_EQ(frames, 2);
}

TEST(McapSource, images_without_stamps_go_by_the_time_of_recording) {
  McapFile file;
  file.add(ImageBag::kInfo, "sensor_msgs/msg/CameraInfo", ImageBag::camera_info(), 0.9);
  for (const double recorded_s : {1.0, 1.1, 1.2}) {
    file.add(ImageBag::kColor, "sensor_msgs/msg/Image", ImageBag::image(ImageBag::color(), "bgr8", 0), recorded_s);
    file.add(ImageBag::kDepth, "sensor_msgs/msg/Image", ImageBag::image(ImageBag::depth(), "16UC1", 0),
             recorded_s + 0.005);
  }
  const auto source = make_source(file.uri());
  EXPECT_THAT(source->info().remarks, testing::ElementsAre(HasSubstr("are all 0")));
  EXPECT_EQ(source->next()->image.stamp_ns, 1'000'000'000);
  EXPECT_EQ(source->next()->image.stamp_ns, 1'100'000'000);
  EXPECT_EQ(source->next()->image.stamp_ns, 1'200'000'000);
  EXPECT_EQ(source->counters().skipped_total(), 0U);
}

TEST(McapSource, plays_frames_of_our_own_first) {
  McapFile file;
  file.add("/camera/color/image_raw/compressed", kCompressed, msg::CompressedImage{}, 1);
  file.add_own(*own_frame(1'000'000'000, 10, 100), 1.0);
  const auto timed = own_frame(1'100'000'000, 11, 65000);
  timed->readout_s = 0.02;
  timed->depth_offset_s = -0.013;
  file.add_own(*timed, 1.1);
  const std::string uri = file.uri();
  const auto source = make_source(uri);
  EXPECT_EQ(source->info().frames, 2U);
  EXPECT_NEAR(source->info().fps, 10, 1e-6);
  EXPECT_DOUBLE_EQ(source->info().depth_scale_m, 0.0002);
  const Played played = play_all(uri);
  ASSERT_THAT(played.frames, SizeIs(2));
  const vision::RgbdImage& image = played.frames[1].image;
  EXPECT_EQ(image.stamp_ns, 1'100'000'000);
  EXPECT_EQ(image.seq, 1U);
  EXPECT_EQ(image.color_bgr.size(), cv::Size(20, 10));
  EXPECT_EQ(image.color_bgr.at<cv::Vec3b>(9, 19), cv::Vec3b(11, 11, 11));
  EXPECT_EQ(image.depth.at<std::uint16_t>(9, 19), 65000);
  EXPECT_DOUBLE_EQ(image.camera.parameters().distortion[0], 0.1);
  EXPECT_EQ(image.readout_s, 0.02);
  EXPECT_EQ(image.depth_offset_s, -0.013);
  EXPECT_EQ(played.frames[0].image.depth_offset_s, 0);
  EXPECT_THAT(played.skipped, IsEmpty());
}

TEST(McapSource, leaves_out_own_frames_that_were_sent_again_or_are_damaged) {
  McapFile file;
  file.add_own(*own_frame(1'000'000'000, 1, 1), 1.0);
  file.add_own(*own_frame(1'000'000'000, 1, 1), 1.1);
  file.add_own(*own_frame(900'000'000, 1, 1), 1.2);
  file.add_own(*own_frame(1'300'000'000, 1, 1), 1.3, 5000);
  auto wide = own_frame(1'400'000'000, 1, 1);
  wide->width = 100'000;
  file.add_own(*wide, 1.4);
  auto other = own_frame(1'500'000'000, 1, 1);
  other->source_id = 8;
  file.add_own(*other, 1.5);
  auto smaller = own_frame(1'600'000'000, 1, 1);
  smaller->width = 10;
  file.add_own(*smaller, 1.6);
  const Played played = play_all(file.uri());
  EXPECT_THAT(played.frames, SizeIs(1));
  EXPECT_EQ(played.counters.of(SkipReason::kStampDoubled), 1U);
  EXPECT_EQ(played.counters.of(SkipReason::kStampBackwards), 1U);
  EXPECT_EQ(played.counters.of(SkipReason::kDamagedRecord), 3U);
  EXPECT_EQ(played.counters.of(SkipReason::kSizeMismatch), 1U);
}

TEST(McapSource, refuses_a_damaged_first_frame) {
  McapFile file;
  auto frame = own_frame(1, 1, 1);
  frame->intrinsics[0] = 0;
  file.add_own(*frame, 1);
  EXPECT_TRUE(test::refuses(file.uri(), {"intrinsics fx 0"}));
}

TEST(McapSource, refuses_frames_of_a_former_version_and_says_so) {
  McapFile file;
  file.add_own(*own_frame(1, 1, 1), 1, 4 + sizeof(msg::RgbdFrame) - 2 * sizeof(double));
  EXPECT_TRUE(test::refuses(file.uri(), {std::to_string(4 + sizeof(msg::RgbdFrame) - 2 * sizeof(double)) + " bytes",
                                         "another version of RTD-SLAM"}));
}

TEST(McapSource, plays_the_intact_part_of_a_cut_file_and_reports_the_loss) {
  McapFile file;
  for (int i = 0; i < 4; ++i) {
    file.add_own(*own_frame(i * 100'000'000 + 1'000'000'000, 1, 1), 1.0 + 0.1 * i);
    file.end_chunk();
  }
  const std::string whole = file.bytes();
  const Played played = play_all(file.uri_of(whole.substr(0, whole.size() * 5 / 8)));
  EXPECT_THAT(played.frames, SizeIs(2));
  EXPECT_GE(played.counters.of(SkipReason::kDamagedRecord), 1U);
}

TEST(McapSource, refuses_other_files_and_files_with_nothing_to_play) {
  const SequenceFolder folder;
  folder.write("x.mcap", "this is no MCAP");
  EXPECT_TRUE(test::refuses("mcap:" + (folder.path() / "x.mcap").string(), {"x.mcap", "MCAP"}));
  EXPECT_TRUE(test::refuses("mcap:/nowhere.mcap", {"/nowhere.mcap"}));
  McapFile file;
  file.add("/slam/pose", "geometry_msgs/msg/PoseStamped", "cdr", {0, 1, 0, 0}, 1);
  EXPECT_TRUE(test::refuses(file.uri(), {"/slam/pose (geometry_msgs/PoseStamped, 1 messages)"}));
}

TEST(McapSource, finds_the_file_in_a_folder_of_rosbag2) {
  const SequenceFolder folder;
  folder.three_frames();
  const auto bag = folder.path() / "bag";
  std::filesystem::create_directory(bag);
  recordings::export_mcap(*make_source(folder.uri()), bag / "bag_0.mcap", mcap::Compression::kNone, 0);
  EXPECT_THAT(play_all("mcap:" + bag.string()).frames, SizeIs(3));
  std::filesystem::copy_file(bag / "bag_0.mcap", bag / "other.mcap");
  EXPECT_TRUE(test::refuses("mcap:" + bag.string(), {"2 recordings of"}));
}

TEST(McapSource, names_the_topics_that_its_frames_are_not_made_of) {
  const SequenceFolder folder;
  folder.three_frames();
  const auto frames = folder.path() / "frames.mcap";
  recordings::export_mcap(*make_source(folder.uri()), frames, mcap::Compression::kNone, 0);
  EXPECT_THAT(auxiliary_topics("mcap:" + frames.string()), ::testing::IsEmpty());
  McapFile own;
  own.add_own(*test::own_frame(1'000'000'000, 100, 5000), 1);
  own.add("/imu", "sensor_msgs/msg/Imu", "cdr", {0, 1, 0, 0}, 1);
  const std::vector<RecordedTopic> auxiliary = auxiliary_topics(own.uri());
  ASSERT_THAT(auxiliary, SizeIs(1));
  EXPECT_EQ(auxiliary[0].name, "/imu");
}

TEST(PlainType, is_the_same_for_every_way_to_name_a_type) {
  for (const char* name :
       {"sensor_msgs/Image", "sensor_msgs/msg/Image", "sensor_msgs::msg::dds_::Image_", "sensor_msgs::msg::Image"}) {
    EXPECT_EQ(plain_type(name), "sensor_msgs/Image") << name;
  }
  EXPECT_EQ(plain_type("Keyed_"), "Keyed_");
}

}  // namespace
}  // namespace rtd::camera
