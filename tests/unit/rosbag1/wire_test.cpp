// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "common/ros_codec/wire.hpp"

namespace rtd::ros {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

msg::TFMessage transforms() {
  msg::TransformStamped transform;
  transform.header = {{12, 34}, "world"};
  transform.child_frame_id = "kinect";
  transform.transform.translation = {1, 2, 3};
  transform.transform.rotation = {0.5, -0.5, 0.5, -0.5};
  return {{transform, transform}};
}

msg::CameraInfo camera_info() {
  msg::CameraInfo info;
  info.header = {{5, 6}, "odd"};
  info.height = 480;
  info.width = 640;
  info.distortion_model = "plumb_bob";
  info.d = {0.1, 0.2, 0.3, 0.4, 0.5};
  info.k = {525, 0, 319.5, 0, 526, 239.5, 0, 0, 1};
  info.p[11] = 7;
  info.binning_y = 8;
  info.roi.do_rectify = true;
  return info;
}

TEST(Wire, both_formats_give_back_what_was_written) {
  const auto check = [](Wire wire, const auto& tf_bytes, const auto& info_bytes) {
    const auto tf = decode<msg::TFMessage>(wire, tf_bytes);
    ASSERT_EQ(tf.transforms.size(), 2U);
    EXPECT_EQ(tf.transforms[1].child_frame_id, "kinect");
    EXPECT_EQ(tf.transforms[1].transform.rotation.w, -0.5);
    const auto info = decode<msg::CameraInfo>(wire, info_bytes);
    EXPECT_EQ(info.distortion_model, "plumb_bob");
    EXPECT_THAT(info.d, ElementsAre(0.1, 0.2, 0.3, 0.4, 0.5));
    EXPECT_EQ(info.k[4], 526);
    EXPECT_EQ(info.p[11], 7);
    EXPECT_EQ(info.binning_y, 8U);
    EXPECT_TRUE(info.roi.do_rectify);
  };
  check(Wire::kRos1, encode<Wire::kRos1>(transforms()), encode<Wire::kRos1>(camera_info()));
  check(Wire::kCdr, encode<Wire::kCdr>(transforms()), encode<Wire::kCdr>(camera_info()));
}

TEST(Wire, cdr_is_aligned_from_behind_its_header) {
  const std::vector<std::uint8_t> bytes = encode<Wire::kCdr>(msg::Header{{1, 2}, "ab"});
  EXPECT_THAT(bytes, ElementsAre(0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 'a', 'b', 0));
  msg::CameraInfo info;
  info.header.frame_id = "x";  // 12 + 2 bytes, padded to 16
  info.d = {1};
  const std::vector<std::uint8_t> padded = encode<Wire::kCdr>(info);
  EXPECT_EQ(padded[4 + 16], 0) << "height is the next aligned word";
  EXPECT_EQ((padded.size() - 4) % 4, 1U) << "ends with the byte do_rectify";
}

TEST(Wire, ros1_is_packed_and_its_header_counts) {
  EXPECT_THAT(encode<Wire::kRos1>(msg::Header{{1, 2}, "ab"}),
              ElementsAre(0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 'a', 'b'));
}

TEST(Wire, every_cut_is_noticed) {
  const auto check = [](Wire wire, const std::vector<std::uint8_t>& bytes) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_THROW(decode<msg::TFMessage>(wire, Bytes(bytes).first(size)), WireError) << size;
    }
  };
  check(Wire::kRos1, encode<Wire::kRos1>(transforms()));
  check(Wire::kCdr, encode<Wire::kCdr>(transforms()));
}

TEST(Wire, a_claim_of4_gb_takes_no_memory) {
  std::vector<std::uint8_t> bytes = encode<Wire::kRos1>(transforms());
  std::fill_n(bytes.begin(), 4, 0xFF);
  EXPECT_THROW(decode<msg::TFMessage>(Wire::kRos1, bytes), WireError);
  msg::CompressedImage image;
  image.data = {1, 2, 3};
  bytes = encode<Wire::kRos1>(image);
  std::fill_n(bytes.end() - 7, 4, 0xFF);
  EXPECT_THAT([&] { decode<msg::CompressedImage>(Wire::kRos1, bytes); },
              ThrowsMessage<WireError>(HasSubstr("4294967295 bytes are claimed")));
}

TEST(Wire, refuses_other_encapsulations_of_cdr) {
  std::vector<std::uint8_t> bytes = encode<Wire::kCdr>(transforms());
  bytes[1] = 0;
  EXPECT_THAT([&] { decode<msg::TFMessage>(Wire::kCdr, bytes); },
              ThrowsMessage<WireError>(HasSubstr("encapsulation 0 0")));
}

}  // namespace
}  // namespace rtd::ros
