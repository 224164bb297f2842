// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/realsense/realsense_protocol.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace rtd::camera::realsense {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

json options_of(const char* stream, const json& intrinsics) {
  return {{"id", "stream-options"}, {"stream-name", stream}, {"intrinsics", intrinsics}, {"options", json::array()}};
}
json header_of(const char* stream, const char* type) {
  return {{"id", "stream-header"},
          {"name", stream},
          {"type", type},
          {"profiles", {{30, type == std::string("depth") ? "16UC1" : "yuv422_yuy2", 1280, 720}}}};
}
const json kIntrinsics = {{"width", 1280},
                          {"height", 720},
                          {"principal-point", {640.5, 357.5}},
                          {"focal-length", {631.5, 632.5}},
                          {"coefficients", {0.1, 0.2, 0.3, 0.4, 0.5}}};

/// Rotation by a quarter turn about z, by columns, and a translation.
const json kTurn = {0, 1, 0, -1, 0, 0, 0, 0, 1, 1, 2, 3};

Description described() {
  Description device;
  device.take({{"id", "device-header"}, {"n-streams", 2}, {"extrinsics", {{"Color", "Depth", kTurn}}}});
  device.take(header_of("Depth", "depth"));
  device.take(options_of("Depth", kIntrinsics));
  device.take(header_of("Color", "color"));
  device.take(options_of("Color", kIntrinsics));
  return device;
}

TEST(RealsenseProtocol, flexible_messages_come_back_as_they_were_written) {
  const json message = {{"id", "log"}, {"entries", {1, "two"}}};
  EXPECT_EQ(read_flexible(write_flexible(message)), message);
}

TEST(RealsenseProtocol, reads_cbor_too) {
  std::vector<std::uint8_t> cdr = {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0};
  const std::vector<std::uint8_t> data = json::to_cbor({{"id", "x"}});
  cdr.insert(cdr.end(), {static_cast<std::uint8_t>(data.size()), 0, 0, 0});
  cdr.insert(cdr.end(), data.begin(), data.end());
  EXPECT_EQ(read_flexible(cdr)["id"], "x");
}

TEST(RealsenseProtocol, messages_that_are_cut_or_no_json_are_refused) {
  const std::vector<std::uint8_t> whole = write_flexible({{"id", "x"}});
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    EXPECT_THROW(read_flexible(ros::Bytes(whole).first(bytes)), ros::WireError) << bytes;
  }
  std::vector<std::uint8_t> broken = whole;
  broken.back() = '[';
  EXPECT_THROW(read_flexible(broken), ros::WireError);
}

TEST(RealsenseProtocol, a_device_that_stops_or_recovers_is_none) {
  const json info = {{"name", "D555"}, {"serial", "12"}, {"topic-root", "realsense/D555_12"}};
  EXPECT_EQ(parse_device_info(info), (DeviceInfo{"D555", "12", "realsense/D555_12"}));
  json recovering = info;
  recovering["recovery"] = true;
  EXPECT_EQ(parse_device_info(recovering), std::nullopt);
  EXPECT_EQ(parse_device_info({{"stopping", true}}), std::nullopt);
  EXPECT_THROW(parse_device_info({{"name", "D555"}}), ros::WireError);
  EXPECT_THROW(parse_device_info(json::array()), ros::WireError);
}

TEST(RealsenseProtocol, a_description_is_complete_with_its_last_message) {
  Description device;
  device.take({{"id", "device-header"}, {"n-streams", 2}});
  device.take(header_of("Depth", "depth"));
  device.take(options_of("Depth", kIntrinsics));
  device.take(header_of("Color", "color"));
  EXPECT_FALSE(device.complete());
  device.take({{"id", "something-new"}});
  device.take(options_of("Color", kIntrinsics));
  EXPECT_TRUE(device.complete());
  EXPECT_EQ(list_modes(device.modes(), Stream::kColor), "1280 x 720 YUYV 30 Hz");
  EXPECT_EQ(list_modes(device.modes(), Stream::kDepth), "1280 x 720 Z16 30 Hz");
}

TEST(RealsenseProtocol, extrinsics_go_from_depth_to_colour_whichever_way_they_are_given) {
  const Eigen::Vector3d p_color(4, 5, 6), p_depth(1 - 5, 2 + 4, 3 + 6);  // the edge maps colour to depth
  const auto T_color_depth = described().T_color_depth();
  ASSERT_TRUE(T_color_depth);
  EXPECT_LT((*T_color_depth * p_depth - p_color).norm(), 1e-12);
  Description unconnected;
  unconnected.take({{"id", "device-header"}, {"n-streams", 2}});
  unconnected.take(header_of("Depth", "depth"));
  unconnected.take(header_of("Color", "color"));
  EXPECT_EQ(unconnected.T_color_depth(), std::nullopt);
}

TEST(RealsenseProtocol, intrinsics_of_another_shape_are_scaled_and_cropped) {
  const auto camera = described().color().camera({640, 480});
  ASSERT_TRUE(camera);
  const double scale = 480.0 / 720;
  EXPECT_NEAR(camera->parameters().fx, 631.5 * scale, 1e-9);
  EXPECT_NEAR(camera->parameters().cx, 641 * scale - (1280 * scale - 640) / 2 - 0.5, 1e-9);
  EXPECT_NEAR(camera->parameters().cy, 358 * scale - 0.5, 1e-9);
  EXPECT_EQ(camera->parameters().distortion[4], 0.5);
  EXPECT_DOUBLE_EQ(described().color().camera({1280, 720})->parameters().cx, 640.5);
}

TEST(RealsenseProtocol, symmetric_images_have_their_principal_point_in_the_middle) {
  json symmetric = kIntrinsics;
  symmetric["force-symmetry"] = true;
  Description device = described();
  device.take(options_of("Color", symmetric));
  const auto camera = device.color().camera({1280, 720});
  EXPECT_NEAR(camera->parameters().cy, 359.5, 1e-9);
  EXPECT_NEAR(camera->parameters().cx, 639.5, 1.0);
  EXPECT_GT(camera->parameters().fy, 632.5) << "what is cropped is scaled up";
}

TEST(RealsenseProtocol, malformed_notifications_name_the_fault) {
  const auto refuses = [](const json& message, const char* text) {
    EXPECT_THAT([&] { described().take(message); }, ThrowsMessage<ros::WireError>(HasSubstr(text))) << message;
  };
  refuses({{"id", "device-header"}, {"n-streams", 1e9}}, "streams");
  refuses({{"id", "device-header"}, {"n-streams", "two"}}, "type must be number");
  refuses({{"id", "device-header"}, {"n-streams", 2}, {"extrinsics", {{"Color", "Depth", {1, 2}}}}}, "not 12");
  refuses({{"id", "device-header"},
           {"n-streams", 2},
           {"extrinsics", {{"Color", "Depth", {1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0}}}}},
          "not a rotation");
  refuses({{"id", "stream-header"}, {"name", "Color"}}, "type");
  json lens = kIntrinsics;
  lens["coefficients"] = {1, 2};
  refuses(options_of("Color", lens), "expected 5");
  lens = kIntrinsics;
  lens["focal-length"] = {0, 0};
  refuses(options_of("Color", lens), "focal length");
  lens = kIntrinsics;
  lens["width"] = -1;
  refuses(options_of("Color", lens), "an image of -1");
}

TEST(RealsenseProtocol, asks_for_a_mode_in_the_words_of_the_device) {
  const Description device = described();
  const std::vector<DeviceMode> modes = device.modes();
  const json request = open_streams(device, modes[0], modes[1]);
  EXPECT_EQ(request["id"], "open-streams");
  EXPECT_EQ(request["stream-profiles"]["Color"], json({30.0, "yuv422_yuy2", 1280, 720}));
  EXPECT_EQ(request["stream-profiles"]["Depth"], json({30.0, "16UC1", 1280, 720}));
  EXPECT_EQ(stream_topic({"", "", "realsense/D_1"}, "Infrared 1"), "rt/realsense/D_1_Infrared_1");
}

}  // namespace
}  // namespace rtd::camera::realsense
