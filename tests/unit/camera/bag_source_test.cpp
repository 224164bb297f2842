// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <limits>

#include "common/camera/recording/ros_images.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/camera/played_frames.hpp"
#include "tests/unit/camera/sequence_folder.hpp"

namespace rtd::camera {
namespace {

using test::ImageBag;
using test::play_all;
using test::Played;
using test::refuses;
using test::SequenceFolder;
using namespace ::testing;

TEST(BagSource, plays_pairs_with_the_stamps_of_their_headers) {
  ImageBag bag;
  bag.three_frames();
  const std::string uri = bag.uri();
  const auto source = make_source(uri);
  EXPECT_EQ(source->info().uri, uri);
  EXPECT_EQ(source->info().frames, 3U);
  EXPECT_NEAR(source->info().fps, 10, 1e-6);
  const Played played = play_all(uri);
  ASSERT_THAT(played.frames, SizeIs(3));
  const vision::RgbdImage& image = played.frames[1].image;
  EXPECT_EQ(image.seq, 1U);
  EXPECT_EQ(image.stamp_ns, 1'100'000'000);
  EXPECT_EQ(image.color_bgr.at<cv::Vec3b>(3, 4), cv::Vec3b(100, 101, 102));
  EXPECT_EQ(image.depth.at<std::uint16_t>(3, 4), 1500);
  EXPECT_DOUBLE_EQ(image.depth_scale_m, 0.001);
  EXPECT_DOUBLE_EQ(image.camera.parameters().fy, 31);
  EXPECT_THAT(played.skipped, IsEmpty());
}

TEST(BagSource, frames_say_how_far_their_images_are_apart_and_what_the_calibration_says) {
  ImageBag bag;
  bag.three_frames();
  const std::string uri = bag.uri();
  for (const SourceFrame& frame : play_all(uri).frames) {
    EXPECT_NEAR(frame.image.depth_offset_s, 0.01, 1e-9);
    EXPECT_EQ(frame.image.readout_s, 0);
  }
  const SequenceFolder folder;
  folder.write("own.yaml", SequenceFolder::calibration(ImageBag::kWidth, ImageBag::kHeight) +
                               "readout_s: 0.02\ndepth_offset_s: -0.004\n");
  const Played played = play_all(uri + "?calibration=" + (folder.path() / "own.yaml").string());
  ASSERT_THAT(played.frames, SizeIs(3));
  for (const SourceFrame& frame : played.frames) {
    EXPECT_NEAR(frame.image.depth_offset_s, 0.006, 1e-9);
    EXPECT_EQ(frame.image.readout_s, 0.02);
  }
}

TEST(BagSource, passes_over_old_frames_which_keep_their_seq) {
  ImageBag bag;
  bag.three_frames();
  test::expect_passes_over_two_of_three(bag.uri());
}

TEST(BagSource, floats_in_millimetres_are_recognised_and_parameters_give_unit_and_camera) {
  const auto first_of = [](double value, const std::string& parameters) {
    ImageBag bag;
    bag.add_info();
    bag.add_color(1);
    bag.add_depth(1, cv::Mat(ImageBag::kHeight, ImageBag::kWidth, CV_32FC1, cv::Scalar(value)), "32FC1");
    const auto source = make_source(bag.uri() + parameters);
    EXPECT_EQ(source->info().notes.size(), value == 1.5 ? 0U : 1U);
    return source->next().value().image;
  };
  const auto metres = [](const vision::RgbdImage& image) {
    return image.depth.at<std::uint16_t>(3, 3) * image.depth_scale_m;
  };
  EXPECT_NEAR(metres(first_of(1.5, "")), 1.5, 1e-3);
  EXPECT_NEAR(metres(first_of(1500, "")), 1.5, 1e-3);
  EXPECT_NEAR(metres(first_of(15000, "?depth_factor=10000")), 1.5, 1e-3);
  EXPECT_EQ(first_of(1.5, "?intrinsics=31,32,15.5,11.5").camera.parameters().fy, 32);
}

TEST(BagSource, depth_without_a_measurement_becomes_zero) {
  ImageBag bag;
  bag.add_info();
  cv::Mat depth_m(ImageBag::kHeight, ImageBag::kWidth, CV_32FC1, cv::Scalar(1.5));
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::array<float, 6> bad = {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity, -1, 13.2F, 1e30F};
  std::copy(bad.begin(), bad.end(), depth_m.ptr<float>(2));
  bag.add_color(1);
  bag.add_depth(1, depth_m, "32FC1");
  bag.add_color(2);
  bag.add_depth(2, cv::Mat(depth_m.size(), CV_32FC1, cv::Scalar(bad[0])), "32FC1");
  const Played played = play_all(bag.uri());
  ASSERT_THAT(played.frames, SizeIs(2));
  EXPECT_EQ(cv::countNonZero(played.frames[0].image.depth), ImageBag::kHeight * ImageBag::kWidth - 6);
  EXPECT_EQ(played.frames[0].image.depth.at<std::uint16_t>(2, 6), 7500);
  EXPECT_DOUBLE_EQ(played.frames[0].image.depth_scale_m, 1.0 / 5000);
  EXPECT_EQ(played.counters.frames_without_depth, 1U);
}

TEST(BagSource, leaves_out_colour_without_depth_and_stamps_that_do_not_grow) {
  ImageBag bag;
  bag.three_frames();
  bag.add_color(1.3);
  for (const double stamp_s : {1.2, 1.3}) {
    bag.add(ImageBag::kColor, "sensor_msgs/Image", ImageBag::image(ImageBag::color(), "bgr8", stamp_s), 1.35);
  }
  bag.add_color(1.4);
  bag.add_depth(1.4);
  const Played played = play_all(bag.uri());
  ASSERT_THAT(played.frames, SizeIs(4));
  EXPECT_EQ(played.frames[3].image.seq, 3U) << "no gap in seq";
  EXPECT_EQ(played.counters.of(SkipReason::kNoDepthPartner), 1U);
  EXPECT_EQ(played.counters.of(SkipReason::kStampBackwards), 1U);
  EXPECT_EQ(played.counters.of(SkipReason::kStampDoubled), 1U);
}

TEST(BagSource, refuses_a_bag_whose_colour_never_has_depth) {
  ImageBag bag;
  bag.add_info();
  bag.add_color(1);
  bag.add_depth(2);
  EXPECT_TRUE(refuses(bag.uri(), {"no usable frame", "1 x no_depth_partner", "no depth image within 0.02 s"}));
}

TEST(BagSource, names_the_topics_there_are_when_one_is_missing) {
  ImageBag bag;
  bag.add_info();
  bag.add_color(1);
  bag.add("/imu", "sensor_msgs/Imu", msg::Header{}, 1);
  const std::string uri = bag.uri();
  EXPECT_TRUE(refuses(uri, {"no depth images", "/imu (sensor_msgs/Imu, 1 messages)", ImageBag::kColor}));
  EXPECT_TRUE(refuses(uri + "?depth=/d", {"no topic /d", "/imu"}));
  EXPECT_TRUE(refuses(uri + "?depth=/imu", {"depth=/imu is of type sensor_msgs/Imu"}));
}

TEST(BagSource, asks_which_when_several_topics_fit) {
  ImageBag two;
  two.add_info();
  for (const char* topic : {"/left/image", "/right/image"}) {
    two.add(topic, "sensor_msgs/Image", ImageBag::image(ImageBag::color(), "bgr8", 1), 1);
  }
  two.add_depth(1);
  const std::string uri = two.uri();
  EXPECT_TRUE(refuses(uri, {"several topics that could be color", "?color=TOPIC", "/left/image", "/right/image"}));
  EXPECT_THAT(play_all(uri + "?color=/right/image").frames, SizeIs(1));
}

TEST(BagSource, names_an_encoding_that_cannot_be_read) {
  const cv::Mat planar(ImageBag::kHeight, ImageBag::kWidth, CV_8UC1), doubles(planar.size(), CV_64FC1, cv::Scalar(1));
  ImageBag color, depth;
  for (ImageBag* const bag : {&color, &depth}) bag->add_info();
  color.add_color(1, planar, "nv42");
  color.add_depth(1);
  depth.add_color(1);
  depth.add_depth(1, doubles, "64FC1");
  EXPECT_TRUE(refuses(color.uri(), {"'nv42'", "rgb8, bgr8", "yuv422", "bayer_grbg16", "JPEG", ImageBag::kColor}));
  EXPECT_TRUE(refuses(depth.uri(), {"'64FC1'", "16UC1 (mm)", "32FC1 (m)", ImageBag::kDepth}));
}

TEST(BagSource, leaves_out_frames_of_other_sizes_and_short_messages) {
  ImageBag bag;
  bag.three_frames();
  bag.add_color(1.3, cv::Mat(10, 10, CV_8UC3, cv::Scalar(1, 2, 3)));
  bag.add_depth(1.3);
  msg::Image lying = ImageBag::image(ImageBag::color(), "bgr8", 1.4);
  lying.height = 4'000'000'000;
  bag.add(ImageBag::kColor, "sensor_msgs/Image", lying, 1.4);
  bag.add_depth(1.4);
  bag.add(ImageBag::kColor, "sensor_msgs/Image", msg::Time{1, 2}, 1.5);
  const Played played = play_all(bag.uri());
  EXPECT_THAT(played.frames, SizeIs(3));
  EXPECT_EQ(played.counters.of(SkipReason::kSizeMismatch), 1U);
  EXPECT_EQ(played.counters.of(SkipReason::kColorUnreadable), 1U);
  EXPECT_EQ(played.counters.of(SkipReason::kDamagedRecord), 1U);
  EXPECT_THAT(played.skipped[1].detail, HasSubstr("10 x 10"));
}

TEST(BagSource, needs_a_calibration_it_understands) {
  msg::CameraInfo large = ImageBag::camera_info(), fisheye = large, thin_prism = large;
  large.width = 2560;
  large.height = 1440;
  fisheye.distortion_model = "equidistant";
  fisheye.d = {0.1, 0, 0, 0, 0.5};
  thin_prism.distortion_model = "thin_prism";
  thin_prism.d = {0.1, 0, 0, 0, 0, 0.2, 0, 0, 0.001, 0, 0, 0};
  const std::vector<std::string> with_a_file = {"?calibration=FILE", ImageBag::kInfo};
  using Row = std::pair<msg::CameraInfo, std::vector<std::string>>;
  for (const auto& [info, words] :
       {Row{large, {"2560 x 1440", "at most 1920 x 1200"}}, Row{ImageBag::camera_info(0), with_a_file},
        Row{ImageBag::camera_info(std::numeric_limits<double>::quiet_NaN()),
            {"a first message is damaged", "sensor_msgs/CameraInfo.k"}},
        Row{fisheye, with_a_file}, Row{thin_prism, with_a_file}}) {
    ImageBag bag;
    bag.one_frame(info);
    EXPECT_TRUE(refuses(bag.uri(), words));
  }
}

TEST(BagSource, knows_rational_and_fisheye_lenses) {
  const auto camera_of = [](const std::string& model, const std::vector<double>& coefficients) {
    msg::CameraInfo info = ImageBag::camera_info();
    info.distortion_model = model;
    info.d = coefficients;
    ImageBag bag;
    bag.one_frame(info);
    return make_source(bag.uri())->info().camera;
  };
  const auto rational = camera_of("rational_polynomial", {0.1, 0, 0, 0, 0, 0.2, 0, 0.05}).parameters();
  EXPECT_EQ(rational.lens, geometry::Lens::kBrownConrady);
  EXPECT_EQ(rational.distortion[5], 0.2);
  EXPECT_EQ(to_camera_info(geometry::CameraModel(rational), 0).distortion_model, "rational_polynomial");
  const auto fisheye = camera_of("equidistant", {0.1, 0, 0, 0.01}).parameters();
  EXPECT_EQ(fisheye.lens, geometry::Lens::kFisheye);
  EXPECT_EQ(fisheye.distortion[3], 0.01);
  EXPECT_EQ(to_camera_info(geometry::CameraModel(fisheye), 0).d.size(), 4U);
}

TEST(BagSource, of_two_cameras_on_one_topic_the_first_is_played_with_its_own_depth) {
  ImageBag bag;
  bag.add_info();
  const auto add = [&bag](const std::string& topic, const cv::Mat& pixels, const char* encoding, const char* frame,
                          double stamp_s) {
    msg::Image image = ImageBag::image(pixels, encoding, stamp_s);
    image.header.frame_id = frame;
    bag.add(topic, "sensor_msgs/Image", image, stamp_s + 0.001);
  };
  add(ImageBag::kDepth, ImageBag::depth(4000), "16UC1", "/rear_optical", 0.99);
  for (const double stamp_s : {1.0, 1.1, 1.2}) {
    add(ImageBag::kColor, ImageBag::color(), "bgr8", "front_optical", stamp_s);
    add(ImageBag::kDepth, ImageBag::depth(1500), "16UC1", "front_optical", stamp_s);
    add(ImageBag::kColor, ImageBag::color(), "bgr8", "rear_optical", stamp_s + 0.005);
    add(ImageBag::kDepth, ImageBag::depth(4000), "16UC1", "rear_optical", stamp_s + 0.005);
  }
  const Played played = play_all(bag.uri());
  ASSERT_THAT(played.frames, SizeIs(3));
  for (const SourceFrame& frame : played.frames) EXPECT_EQ(frame.image.depth.at<std::uint16_t>(3, 3), 1500);
  ASSERT_THAT(played.skipped, SizeIs(3));
  EXPECT_EQ(played.skipped[0].reason, SkipReason::kOtherCamera);
  EXPECT_THAT(played.skipped[0].detail,
              AllOf(HasSubstr("/camera/rgb/image_color"), HasSubstr("'front_optical'"), HasSubstr("'rear_optical'")));
}

TEST(BagSource, camera_info_of_the_whole_sensor_is_cropped_and_binned) {
  const auto camera_of = [](std::uint32_t width, std::uint32_t height, std::uint32_t binning,
                            msg::RegionOfInterest roi) {
    msg::CameraInfo info = ImageBag::camera_info(60);
    info.width = width;
    info.height = height;
    info.binning_x = info.binning_y = binning;
    info.roi = roi;
    ImageBag bag;
    bag.one_frame(info);
    return make_source(bag.uri())->info().camera.parameters();
  };
  const auto binned = camera_of(64, 48, 2, {});
  EXPECT_EQ((std::array{binned.fx, binned.cx, binned.fy}), (std::array{30.0, 7.75, 15.5}));
  const auto cropped = camera_of(64, 48, 0, {.x_offset = 10, .y_offset = 4, .height = 24, .width = 32});
  EXPECT_EQ((std::array{cropped.fx, cropped.cx, cropped.cy}), (std::array{60.0, 5.5, 7.5}));
  EXPECT_EQ(camera_of(32, 24, 2, {}).fx, 60) << "a driver that gives that of the image";
}

TEST(BagSource, the_left_infrared_camera_takes_the_place_of_colour) {
  ImageBag bag;
  for (const char* stream : {"/camera/camera/infra1", "/camera/camera/depth"}) {
    const bool depth = std::string(stream).ends_with("depth");
    msg::Image image = depth ? ImageBag::image(ImageBag::depth(), "16UC1", 1)
                             : ImageBag::image(cv::Mat(24, 32, CV_8UC1, cv::Scalar(90)), "mono8", 1);
    image.header.frame_id = depth ? "camera_depth_optical_frame" : "camera_infra1_optical_frame";
    bag.add(std::string(stream) + "/camera_info", "sensor_msgs/CameraInfo", ImageBag::camera_info(), 0.5);
    bag.add(std::string(stream) + "/image_rect_raw", "sensor_msgs/Image", image, 1);
  }
  const Played played = play_all(bag.uri());
  ASSERT_THAT(played.frames, SizeIs(1));
  EXPECT_EQ(played.frames[0].image.color_bgr.at<cv::Vec3b>(3, 3), cv::Vec3b(90, 90, 90));
}

/// A first image of 10 bits, dark but for a few pixels, and one with more light.
TEST(BagSource, infrared_of_16_bits_is_scaled_as_its_first_image_needs_and_stays_so) {
  for (const char* encoding : {"mono16", "16UC1"}) {
    ImageBag bag;
    for (const double stamp_s : {1.0, 1.1}) {
      cv::Mat grey(24, 32, CV_16UC1, cv::Scalar(stamp_s > 1 ? 1500 : 600));
      grey.at<std::uint16_t>(0, 0) = 65535;
      grey.at<std::uint16_t>(3, 3) = 203;
      bag.add("/kinect/ir/image_raw", "sensor_msgs/Image", ImageBag::image(grey, encoding, stamp_s), stamp_s);
      bag.add("/kinect/depth/image_raw", "sensor_msgs/Image", ImageBag::image(ImageBag::depth(), "16UC1", stamp_s),
              stamp_s);
    }
    bag.add("/kinect/ir/camera_info", "sensor_msgs/CameraInfo", ImageBag::camera_info(), 0.5);
    const auto source = make_source(bag.uri());
    EXPECT_THAT(source->info().notes, Contains(HasSubstr("of 10 bits of grey")));
    const Played played = play_all(bag.uri());
    ASSERT_THAT(played.frames, SizeIs(2));
    const auto grey = [&](std::size_t frame, int at) {
      return int{played.frames[frame].image.color_bgr.at<cv::Vec3b>(at, at)[0]};
    };
    EXPECT_EQ((std::array{grey(0, 3), grey(0, 9), grey(0, 0)}), (std::array{203 / 4, 600 / 4, 255}));
    EXPECT_EQ((std::array{grey(1, 3), grey(1, 9)}), (std::array{203 / 4, 255}));
    EXPECT_TRUE(refuses(bag.uri() + "?color=/kinect/depth/image_raw&depth=/kinect/depth/image_raw", {"'16UC1'"}));
  }
}

TEST(BagSource, takes_a_calibration_of_its_own) {
  ImageBag bag;
  bag.add_color(1);
  bag.add_depth(1);
  const std::string uri = bag.uri();
  EXPECT_TRUE(refuses(uri, {"no sensor_msgs/CameraInfo", "?calibration=FILE"}));
  const rtd::test::TemporaryFile file("c.yaml", test::SequenceFolder::calibration(32, 24));
  const auto source = make_source(uri + "?calibration=" + file.path().string());
  EXPECT_DOUBLE_EQ(source->info().camera.parameters().fx, 52);
  EXPECT_DOUBLE_EQ(source->info().depth_scale_m, 1.0 / 5000);
}

TEST(BagSource, rectified_images_have_the_projections_camera) {
  msg::CameraInfo info = ImageBag::camera_info();
  info.d = {0.1, 0.2, 0, 0, 0};
  info.p = {28, 0, 14, 0, 0, 29, 11, 0, 0, 0, 1, 0};
  ImageBag bag;
  bag.add_info(info);
  bag.add("/camera/rgb/image_rect_color", "sensor_msgs/Image", ImageBag::image(ImageBag::color(), "rgb8", 1), 1);
  bag.add_depth(1);
  const auto camera = make_source(bag.uri())->info().camera;
  EXPECT_DOUBLE_EQ(camera.parameters().fx, 28);
  EXPECT_DOUBLE_EQ(camera.parameters().cy, 11);
  EXPECT_FALSE(camera.distorted());
}

TEST(BagSource, gives_ground_truth_only_in_a_world_frame) {
  const auto bag_with = [](const char* root, const char* child) {
    auto bag = std::make_unique<ImageBag>();
    bag->three_frames();
    for (const double stamp_s : {0.4, 0.6, 1.1, 1.9}) {
      msg::TransformStamped transform;
      transform.header = {msg::to_time(static_cast<std::int64_t>(stamp_s * 1e9)), root};
      transform.child_frame_id = child;
      transform.transform.translation.x = stamp_s;
      bag->add("/tf", "tf/tfMessage", msg::TFMessage{{transform}}, stamp_s);
    }
    return bag;
  };
  const auto played = [](ImageBag& bag) {
    auto source = make_source(bag.uri());
    while (source->next()) continue;
    return source;
  };
  const auto truth = [&](ImageBag& bag) { return played(bag)->groundtruth(); };
  const auto poses = truth(*bag_with("/world", "/kinect"));
  ASSERT_THAT(poses, SizeIs(2)) << "of the span of the frames and half a second around it";
  EXPECT_EQ(poses[1].stamp_ns, 1'100'000'000);
  EXPECT_DOUBLE_EQ(poses[1].T_world_body.translation().x(), 1.1);
  const auto bag = bag_with("/world", "/kinect");
  const auto source = played(*bag);
  ASSERT_TRUE(source->true_pose(1'100'000'000));
  EXPECT_DOUBLE_EQ(source->true_pose(1'100'000'000)->translation().x(), 1.1);
  EXPECT_FALSE(source->true_pose(1'040'000'000)) << "nothing measured within 50 ms";
  EXPECT_THAT(truth(*bag_with("/odom", "/kinect")), IsEmpty());
  EXPECT_THAT(truth(*bag_with("/world", "/robot")), IsEmpty());
  EXPECT_THAT(truth(*bag_with("/kinect", "/kinect")), IsEmpty()) << "a ring";
}

TEST(BagSource, plays_the_intact_part_of_a_damaged_bag_and_reports_the_loss) {
  ImageBag bag("none");
  bag.three_frames();
  const std::string whole = bag.bytes();
  const Played cut = play_all(bag.uri_of(whole.substr(0, whole.size() / 2)));
  EXPECT_THAT(cut.frames, SizeIs(1));
  EXPECT_EQ(cut.counters.of(SkipReason::kDamagedRecord), 1U);
  EXPECT_THAT(cut.skipped[0].detail, HasSubstr("what follows is lost"));
}

TEST(BagSource, names_the_parameters_it_knows) {
  EXPECT_TRUE(refuses("bag:", {"needs a file", "bag:FILE"}));
  EXPECT_TRUE(
      refuses("bag:x?colour=/a",
              {"unknown parameter 'colour'",
               "color, depth, info, depth_info, registered, tolerance_ms, calibration, depth_factor, intrinsics"}));
  EXPECT_TRUE(refuses("bag:/nowhere.bag", {"/nowhere.bag cannot be read"}));
}

}  // namespace
}  // namespace rtd::camera
