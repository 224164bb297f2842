// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Recordings whose depth was taken by another camera than colour: registered, or refused with the reason.
#include <gmock/gmock.h>

#include <array>
#include <bit>
#include <opencv2/imgcodecs.hpp>

#include "common/camera/depth_alignment.hpp"
#include "common/camera/depth_figures.hpp"
#include "common/geometry/transform_log.hpp"
#include "tests/unit/camera/image_bag.hpp"
#include "tests/unit/camera/mcap_file.hpp"
#include "tests/unit/camera/played_frames.hpp"
#include "tests/unit/camera/sequence_folder.hpp"
#include "tests/unit/camera/two_cameras.hpp"

namespace rtd::camera {
namespace {

using test::ImageBag;
using test::McapFile;
using test::play;
using test::SequenceFolder;
using test::TwoCameras;
using namespace ::testing;

constexpr const char* kRosImage = "sensor_msgs/Image";
constexpr const char* kRosInfo = "sensor_msgs/CameraInfo";
constexpr const char* kColorTopic = "/camera/color/image_raw";
constexpr const char* kDepthTopic = "/camera/depth/image_rect_raw";
constexpr const char* kDepthInfo = "/camera/depth/camera_info";

/// As a ROS driver records them: colour and depth each in a frame of its own.
void add_images(ImageBag& bag, const TwoCameras& cameras) {
  bag.add("/camera/color/camera_info", kRosInfo, TwoCameras::info(cameras.color), 1);
  bag.add(kColorTopic, kRosImage, cameras.color_image(1), 1);
  bag.add(kDepthTopic, kRosImage, cameras.depth_image(1), 1);
}
void add_calibrated(ImageBag& bag, const TwoCameras& cameras) {
  add_images(bag, cameras);
  bag.add(kDepthInfo, kRosInfo, TwoCameras::info(cameras.depth), 1);
}
std::string uri_of(ImageBag& bag) {
  return bag.uri() + "?depth=" + kDepthTopic;
}

/// The image of the only frame.
vision::RgbdImage play_one(const std::string& uri) {
  const auto frames = play(uri);
  EXPECT_THAT(frames, SizeIs(1));
  return frames.at(0).image;
}

template <class Words>
void expect_refused(const std::string& uri, const Words& words) {
  EXPECT_THAT([&] { make_source(uri); }, ThrowsMessage<SourceError>(words));
}

TEST(Registration, of_a_bag_by_its_camera_infos_and_tf_static) {
  const TwoCameras cameras;
  ImageBag bag;
  add_calibrated(bag, cameras);
  bag.add("/tf_static", "tf2_msgs/TFMessage", cameras.transforms(), 1);
  const auto image = play_one(uri_of(bag));
  EXPECT_EQ(image.camera.parameters(), cameras.color.parameters());
  cameras.expect_registered(image);
}

TEST(Registration, of_a_bag_by_tf_of_old) {
  const TwoCameras cameras;
  ImageBag bag;
  add_calibrated(bag, cameras);
  bag.add("/tf", "tf/tfMessage", cameras.transforms("/"), 1);
  cameras.expect_registered(play_one(uri_of(bag)));
}

TEST(Registration, of_an_mcap_file_with_the_info_of_depth_elsewhere) {
  const TwoCameras cameras;
  McapFile file;
  file.add(kColorTopic, "sensor_msgs/msg/Image", cameras.color_image(1), 1);
  file.add(kDepthTopic, "sensor_msgs/msg/Image", cameras.depth_image(1), 1);
  file.add("/camera/color/camera_info", "sensor_msgs/msg/CameraInfo", TwoCameras::info(cameras.color), 1);
  file.add("/elsewhere", "sensor_msgs/msg/CameraInfo", TwoCameras::info(cameras.depth), 1);
  file.add("/tf_static", "tf2_msgs/msg/TFMessage", cameras.transforms(), 1);
  const std::string uri = file.uri() + "?depth=" + kDepthTopic;
  expect_refused(uri, AllOf(HasSubstr("depth is not registered"), HasSubstr("?depth_info=TOPIC")));
  cameras.expect_registered(play_one(uri + "&depth_info=/elsewhere"));
  EXPECT_EQ(make_source(uri + "&depth_info=/elsewhere")->info().frame_id, cameras.color_frame);
}

/// As the RealSense SDK records: every image in frame "0", transforms from a reference stream to each stream.
void add_sdk(ImageBag& bag, const TwoCameras& cameras, bool with_transforms) {
  const std::string color = "/device_0/sensor_1/Color_0/", depth = "/device_0/sensor_0/Depth_0/";
  msg::Image color_image = cameras.color_image(1), depth_image = cameras.depth_image(1);
  color_image.header.frame_id = depth_image.header.frame_id = "0";
  depth_image.encoding = "mono16";
  bag.add(color + "info/camera_info", kRosInfo, TwoCameras::info(cameras.color), 0.5);
  bag.add(depth + "info/camera_info", kRosInfo, TwoCameras::info(cameras.depth), 0.5);
  if (with_transforms) {
    const Eigen::Isometry3d T_depth_reference(Eigen::Translation3d(0.3, 0.1, 0.2));
    bag.add(color + "tf/0", "geometry_msgs/Transform", TwoCameras::transform(cameras.T_color_depth * T_depth_reference),
            0.5);
    bag.add(depth + "tf/0", "geometry_msgs/Transform", TwoCameras::transform(T_depth_reference), 0.5);
  }
  bag.add(color + "image/data", kRosImage, color_image, 1);
  bag.add(depth + "image/data", kRosImage, depth_image, 1);
}
constexpr const char* kSdkTopics =
    "?color=/device_0/sensor_1/Color_0/image/data&depth=/device_0/sensor_0/Depth_0/image/data";

TEST(Registration, of_a_realsense_sdk_bag_by_the_transforms_in_it) {
  const TwoCameras cameras;
  ImageBag bag;
  add_sdk(bag, cameras, true);
  cameras.expect_registered(play_one(bag.uri() + kSdkTopics));
}

TEST(Registration, a_realsense_sdk_bag_is_never_accepted_as_it_is) {
  ImageBag bag;
  add_sdk(bag, TwoCameras(), false);
  expect_refused(bag.uri() + kSdkTopics, AllOf(HasSubstr("not registered"), HasSubstr(".../tf/0")));
  TwoCameras alike;
  alike.depth = alike.color;
  ImageBag same_intrinsics;
  add_sdk(same_intrinsics, alike, false);
  const std::string uri = same_intrinsics.uri() + kSdkTopics;
  expect_refused(uri, AllOf(HasSubstr("frame '0'"), HasSubstr("?registered=1")));
  EXPECT_THAT(play(uri + "&registered=1"), SizeIs(1));
}

constexpr const char* kProfileDefinition =
    "std_msgs/Header header\nuint8 streamType\nuint8 format\nfloat32[9] rotationMatrix\nfloat32[3] translationMatrix\n"
    "uint16 width\nuint16 height\nuint16 fps\nfloat32[4] cameraIntrinsic\nfloat32[8] cameraDistortion\n"
    "uint8 distortionModel\n";

void append(std::vector<std::uint8_t>& bytes, auto value) {
  const auto raw = std::bit_cast<std::array<std::uint8_t, sizeof(value)>>(value);
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}
/// A stream profile as Orbbec's SDK 2 records it: 121 bytes.
std::vector<std::uint8_t> orbbec_profile(const geometry::CameraModel& camera, const Eigen::Isometry3d& T_color_this) {
  std::vector<std::uint8_t> bytes(18);
  const auto add = [&bytes](auto value) { append(bytes, value); };
  const auto add_float = [&add](double value) { add(static_cast<float>(value)); };
  for (const double value : T_color_this.linear().transpose().reshaped()) add_float(value);
  for (const double value : T_color_this.translation()) add_float(1000 * value);
  const auto& p = camera.parameters();
  for (const int value : {p.width, p.height, 30}) add(static_cast<std::uint16_t>(value));
  for (const double value : {p.fx, p.fy, p.cx, p.cy}) add_float(value);
  for (const std::size_t i : {0, 1, 4, 5, 6, 7, 2, 3}) add_float(p.distortion[i]);
  add(std::uint8_t{4});  // Brown-Conrady with six radial coefficients
  return bytes;
}

void add_orbbec(ImageBag& bag, const TwoCameras& cameras, const Eigen::Isometry3d& T_color_depth) {
  msg::Image color = cameras.color_image(1), depth = cameras.depth_image(1);
  color.header.frame_id = depth.header.frame_id = "";
  color.encoding = "mjpg";
  cv::imencode(".jpg", cv::Mat(TwoCameras::kHeight, TwoCameras::kWidth, CV_8UC3, cv::Scalar(90, 90, 90)), color.data);
  depth.encoding = "z16";
  const auto profile = [&](const char* stream, const geometry::CameraModel& camera, const Eigen::Isometry3d& T) {
    bag.add_defined(std::string("/cam/streamProfileType_") + stream, "custom_msg/OBStreamProfileInfo",
                    kProfileDefinition, orbbec_profile(camera, T), 1);
  };
  profile("2", cameras.color, Eigen::Isometry3d(Eigen::Matrix4d::Zero()));
  profile("3", cameras.depth, T_color_depth);
  bag.add("/cam/sensor_6/frameType_8", kRosImage, cameras.color_image(1), 1);
  bag.add("/cam/sensor_2/frameType_2", kRosImage, color, 1);
  bag.add("/cam/sensor_3/frameType_3", kRosImage, depth, 1);
}

/// A property of the device as the SDK records it: its number has four bytes, whatever the definition says.
void add_orbbec_property(ImageBag& bag, std::uint32_t number, auto value) {
  std::vector<std::uint8_t> bytes(16);  // header
  append(bytes, number);
  append(bytes, static_cast<std::uint32_t>(sizeof value));
  append(bytes, value);
  append(bytes, static_cast<std::uint32_t>(sizeof value));
  bag.add_defined("/cam/property", "custom_msg/OBProperty",
                  "std_msgs/Header header\nuint8 propertyId\nuint8[] data\nuint32 datasize\n", bytes, 0.5);
}
double depth_unit_of_orbbec(std::uint32_t number, auto value) {
  const TwoCameras cameras;
  ImageBag bag;
  add_orbbec_property(bag, 1024, std::uint64_t{75});
  add_orbbec_property(bag, number, value);
  add_orbbec(bag, cameras, cameras.T_color_depth);
  return play_one(bag.uri()).depth_scale_m;
}
TEST(Registration, of_an_orbbec_sdk_bag_in_the_depth_unit_among_its_properties) {
  EXPECT_NEAR(depth_unit_of_orbbec(176, 0.25F), 0.00025, 1e-9) << "Gemini 330: millimetres";
  EXPECT_NEAR(depth_unit_of_orbbec(75, std::uint32_t{3}), 0.0001, 1e-9) << "a level of precision";
  EXPECT_NEAR(depth_unit_of_orbbec(75, std::uint32_t{7}), 0.001, 1e-9) << "no level";
  EXPECT_NEAR(depth_unit_of_orbbec(76, std::uint32_t{3}), 0.001, 1e-9) << "another property";
  ImageBag bag;
  add_orbbec_property(bag, 176, 0.0F);
  add_orbbec(bag, TwoCameras(), TwoCameras().T_color_depth);
  expect_refused(bag.uri(), AllOf(HasSubstr("/cam/property"), HasSubstr("?depth_factor=")));
}

TEST(Registration, of_an_orbbec_sdk_bag_by_its_stream_profiles) {
  const TwoCameras cameras;
  ImageBag bag;
  add_orbbec(bag, cameras, cameras.T_color_depth);
  const auto image = play_one(bag.uri());
  EXPECT_NEAR(image.color_bgr.at<cv::Vec3b>(20, 20)[0], 90, 2);
  EXPECT_LT(difference_px(image.camera, cameras.color), 1e-3);
  EXPECT_NEAR(image.camera.parameters().distortion[2], 0.001, 1e-6);
  cameras.expect_registered(image);
  ImageBag without_color;
  add_orbbec(without_color, cameras, Eigen::Isometry3d(Eigen::Matrix4d::Zero()));
  expect_refused(without_color.uri(), HasSubstr("the transform between the two frames"));
}

TEST(Registration, depth_in_another_frame_without_a_transform_or_an_info_is_refused) {
  const TwoCameras cameras;
  ImageBag without_info;
  add_images(without_info, cameras);
  without_info.add("/tf_static", "tf2_msgs/TFMessage", cameras.transforms(), 1);
  expect_refused(uri_of(without_info), AllOf(HasSubstr("?depth_info=TOPIC"), HasSubstr("64 x 48")));
  ImageBag without_transform;
  add_calibrated(without_transform, cameras);
  expect_refused(uri_of(without_transform), AllOf(HasSubstr("tf_static"), HasSubstr("?registered=1")));
  ImageBag bad_info;
  add_images(bad_info, cameras);
  bad_info.add(kDepthInfo, kRosInfo, msg::CameraInfo(), 1);
  expect_refused(uri_of(bad_info), AllOf(HasSubstr("not registered"), HasSubstr("not calibrated")));
}

TEST(Registration, one_frame_with_other_intrinsics_is_another_raster) {
  TwoCameras cameras;
  cameras.T_color_depth = Eigen::Isometry3d::Identity();
  cameras.depth_frame = cameras.color_frame;
  ImageBag bag;
  add_calibrated(bag, cameras);
  cameras.expect_registered(play_one(uri_of(bag)));
}

TEST(Registration, a_calibration_file_is_that_of_colour_and_of_the_depth_unit) {
  TwoCameras cameras;
  cameras.depth_frame = cameras.color_frame;
  cameras.T_color_depth = Eigen::Isometry3d::Identity();
  cameras.depth = geometry::CameraModel({50, 50, 32, 24, {}, TwoCameras::kWidth, TwoCameras::kHeight});
  ImageBag bag;
  add_calibrated(bag, cameras);
  const std::string uri = uri_of(bag);
  std::string text = SequenceFolder::calibration(TwoCameras::kWidth, TwoCameras::kHeight);
  text.replace(text.find("5000"), 4, "1000");
  const rtd::test::TemporaryFile file("c.yaml", text);
  const auto image = play_one(uri + "&calibration=" + file.path().string());
  cameras.color = image.camera;
  EXPECT_DOUBLE_EQ(cameras.color.parameters().fx, 52);
  cameras.expect_registered(image);
}

TEST(Registration, damaged_transforms_do_not_count) {
  const TwoCameras cameras;
  ImageBag bag;
  add_calibrated(bag, cameras);
  bag.add("/tf_static", "tf2_msgs/TFMessage", msg::Time{7, 7}, 1);
  msg::TFMessage no_rotation = cameras.transforms();
  for (auto& transform : no_rotation.transforms) transform.transform.rotation = {0, 0, 0, 0};
  bag.add("/tf_static", "tf2_msgs/TFMessage", no_rotation, 1);
  expect_refused(uri_of(bag), HasSubstr("tf_static"));
}

TEST(Alignment, is_judged_by_sizes_intrinsics_names_and_frames) {
  const TwoCameras cameras;
  const cv::Size size(64, 48);
  const ImageOrigin color{"/c", "optical", size, cameras.color};
  const auto why = [&](const ImageOrigin& depth) { return why_unregistered(color, depth); };
  EXPECT_THAT(why({"/d", "optical", size, {}}), IsEmpty());
  EXPECT_THAT(why({"/d", "/optical", size, cameras.color}), IsEmpty());
  EXPECT_THAT(why({"/camera/aligned_depth_to_color/image_raw", "other", size, cameras.color}), IsEmpty());
  EXPECT_THAT(why({"/d", "optical", {32, 24}, {}}), HasSubstr("32 x 24"));
  EXPECT_THAT(why({"/d", "optical", size, cameras.depth}), HasSubstr("fx"));
  EXPECT_THAT(why({"/camera/aligned_depth_to_color/image_raw", "optical", size, cameras.depth}), HasSubstr("fx"));
  EXPECT_THAT(why({"/d", "other", size, cameras.color}), HasSubstr("'other'"));
  for (const char* frame : {"", "/", "0"}) {
    const ImageOrigin nowhere{"/c", frame, size, cameras.color};
    EXPECT_THAT(why_unregistered(nowhere, {"/d", frame, size, cameras.color}), HasSubstr("does not say")) << frame;
  }
  geometry::CameraModel::Parameters close = cameras.color.parameters();
  close.cx += 0.4;
  EXPECT_THAT(why({"/d", "optical", size, geometry::CameraModel(close)}), IsEmpty());
  close.cx += 0.2;
  EXPECT_THAT(why({"/d", "optical", size, geometry::CameraModel(close)}), HasSubstr("cx"));
}

TEST(TransformLog, joins_two_frames_by_the_frame_above_both) {
  const auto link = [](const char* parent, const char* child, double x) {
    msg::TransformStamped transform;
    transform.header.frame_id = parent;
    transform.child_frame_id = child;
    transform.transform.translation.x = x;
    return transform;
  };
  geometry::TransformLog log;
  log.add({{link("base", "left", 1), link("left", "left_optical", 0.1), link("base", "right", 5)}});
  const auto T_left_right = log.between("left_optical", "/right");
  ASSERT_TRUE(T_left_right);
  EXPECT_NEAR(T_left_right->translation().x(), 3.9, 1e-12);
  EXPECT_NEAR(log.between("right", "left_optical")->translation().x(), -3.9, 1e-12);
  EXPECT_FALSE(log.between("left", "elsewhere"));
  log.add({{link("left_optical", "base", 0)}});
  EXPECT_FALSE(log.between("left", "elsewhere")) << "a ring";
}

TEST(PairingTolerance, is_an_option_of_every_source) {
  ImageBag bag;
  bag.add_info();
  bag.add_color(1.0);
  bag.add_depth(1.01);
  bag.add_color(1.1);
  bag.add_depth(1.14);
  const std::string uri = bag.uri();
  EXPECT_THAT(play(uri), SizeIs(1));
  EXPECT_THAT(play(uri + "?tolerance_ms=45"), SizeIs(2));
  EXPECT_EQ(play(uri + "?tolerance_ms=45")[1].depth_after_color_ns, 40'000'000);
  const SequenceFolder folder;
  folder.three_frames();
  folder.write("depth.txt", "1.0 depth/1.0.png\n1.13 depth/1.1.png\n1.2 depth/1.2.png\n");
  const auto strict = play(folder.uri());
  const auto wide = play(folder.uri() + "?tolerance_ms=40");
  EXPECT_EQ(wide.size(), strict.size() + 1);
  EXPECT_EQ(wide[1].depth_after_color_ns, 30'000'000);
  for (const std::string value : {"0", "-1", "1001", "x"}) {
    expect_refused("tum:/x?tolerance_ms=" + value, HasSubstr("tolerance_ms is '" + value + "'"));
    expect_refused("bag:/x?tolerance_ms=" + value, HasSubstr("at most 1000"));
  }
  expect_refused("bag:/x?registered=yes", HasSubstr("registered is 0 or 1"));
}

TEST(DepthOffsets, give_the_median_of_the_newest) {
  DepthOffsets offsets;
  EXPECT_FALSE(offsets.median_ms());
  for (const int ms : {40, 5, 6, 7, -900}) offsets.add(ms * 1'000'000);
  EXPECT_DOUBLE_EQ(*offsets.median_ms(), 6);
  for (std::size_t i = 0; i < DepthOffsets::kNewest; ++i) offsets.add(-2'500'000);
  EXPECT_EQ(offsets.size(), DepthOffsets::kNewest);
  EXPECT_DOUBLE_EQ(*offsets.median_ms(), -2.5);
}

}  // namespace
}  // namespace rtd::camera
