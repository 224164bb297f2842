// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "common/bus/fastdds/converted_type.hpp"
#include "tests/unit/bus/random_message.hpp"

namespace rtd::bus::fastdds {
namespace {

template <class T>
class Conversion : public testing::Test {};
using ConvertedMessages =
    testing::Types<msg::ServiceStatus, msg::CompressedImage, msg::Image, msg::CameraInfo, msg::Detection2DArray,
                   msg::Odometry, msg::PoseStamped, msg::TFMessage, msg::Path, msg::PointCloud2, msg::DiagnosticArray>;
TYPED_TEST_SUITE(Conversion, ConvertedMessages);

/// Through conversion, XCDR1 bytes and back.
template <class T>
T through_the_wire(const T& message) {
  typename ConvertedType<T>::PubSub type;
  VendorOf<T> sent, received;
  ToVendor{}(message, sent);
  eprosima::fastrtps::rtps::SerializedPayload_t payload(type.getSerializedSizeProvider(&sent)());
  EXPECT_TRUE(type.serialize(&sent, &payload));
  EXPECT_TRUE(type.deserialize(&payload, &received));
  T back;
  FromVendor{}(back, received);
  return back;
}

TYPED_TEST(Conversion, keeps_every_field) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 20; ++round) {
    TypeParam message;
    reflect::randomize(message, random);
    EXPECT_EQ(reflect::fingerprint(through_the_wire(message)), reflect::fingerprint(message));
  }
}

TYPED_TEST(Conversion, empty_message_stays_empty) {
  EXPECT_EQ(reflect::fingerprint(through_the_wire(TypeParam{})), reflect::fingerprint(TypeParam{}));
}

TYPED_TEST(Conversion, a_reused_target_forgets_its_old_content) {
  std::mt19937_64 random(8);
  TypeParam old, empty;
  reflect::randomize(old, random);
  VendorOf<TypeParam> vendor;
  ToVendor{}(old, vendor);
  ToVendor{}(empty, vendor);
  FromVendor{}(old, vendor);
  EXPECT_EQ(reflect::fingerprint(old), reflect::fingerprint(empty));
}

TYPED_TEST(Conversion, has_its_ros2_name) {
  const std::string name = typename ConvertedType<TypeParam>::PubSub().getName();
  EXPECT_NE(name.find("::msg::dds_::"), std::string::npos) << name;
  EXPECT_EQ(name.back(), '_') << name;
  EXPECT_EQ(name.find("dds_::dds_"), std::string::npos) << name;
}

TYPED_TEST(Conversion, refuses_bytes_cut_short_and_absurd_lengths) {
  std::mt19937_64 random(9);
  TypeParam message;
  reflect::randomize(message, random);
  SafeType<TypeParam> type;
  VendorOf<TypeParam> vendor, received;
  ToVendor{}(message, vendor);
  eprosima::fastrtps::rtps::SerializedPayload_t payload(type.getSerializedSizeProvider(&vendor)());
  ASSERT_TRUE(type.serialize(&vendor, &payload));
  const std::uint32_t whole = payload.length;
  for (const std::uint32_t length : {whole - 1, whole / 2, 5U}) {
    payload.length = length;
    EXPECT_FALSE(type.deserialize(&payload, &received)) << length << " of " << whole << " bytes";
  }
  payload.length = whole;
  for (std::uint32_t i = 4; i < whole; ++i) payload.data[i] = 0xff;  // every length is 4 billion
  EXPECT_FALSE(type.deserialize(&payload, &received));
}

TEST(Fingerprint, changes_with_every_kind_of_field) {
  msg::CameraInfo info;
  const auto original = reflect::fingerprint(info);
  const auto changed = [&](auto change) {
    msg::CameraInfo other = info;
    change(other);
    return reflect::fingerprint(other) != original;
  };
  EXPECT_TRUE(changed([](auto& i) { i.header.stamp.nanosec = 1; }));
  EXPECT_TRUE(changed([](auto& i) { i.d.push_back(0.0); }));
  EXPECT_TRUE(changed([](auto& i) { i.p[11] = 1.0; }));
  EXPECT_TRUE(changed([](auto& i) { i.distortion_model = "plumb_bob"; }));
  EXPECT_TRUE(changed([](auto& i) { i.roi.do_rectify = true; }));
}

}  // namespace
}  // namespace rtd::bus::fastdds
