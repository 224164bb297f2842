// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// common/ros_codec against the code that was generated from idl/.
#include <gtest/gtest.h>

#include <random>

#include "common/bus/fastdds/field_maps_ros.hpp"
#include "common/ros_codec/wire_reader.hpp"
#include "common/ros_codec/wire_writer.hpp"
#include "tests/unit/bus/random_message.hpp"

namespace rtd::bus::fastdds {
namespace {

using eprosima::fastrtps::rtps::SerializedPayload_t;

template <class Plain, class GeneratedType>
struct Pair {
  using plain = Plain;
  using type = GeneratedType;
};

template <class T>
class Cdr : public testing::Test {};
using Messages = testing::Types<Pair<msg::Image, sensor_msgs::msg::dds_::Image_PubSubType>,
                                Pair<msg::CompressedImage, sensor_msgs::msg::dds_::CompressedImage_PubSubType>,
                                Pair<msg::CameraInfo, sensor_msgs::msg::dds_::CameraInfo_PubSubType>,
                                Pair<msg::TFMessage, tf2_msgs::msg::dds_::TFMessage_PubSubType>>;
TYPED_TEST_SUITE(Cdr, Messages);

TYPED_TEST(Cdr, gives_and_reads_the_bytes_of_the_generated_serialiser) {
  using Plain = typename TypeParam::plain;
  std::mt19937_64 random(9);
  for (int i = 0; i < 200; ++i) {
    Plain plain;
    reflect::randomize(plain, random);
    VendorOf<Plain> vendor;
    ToVendor()(plain, vendor);
    typename TypeParam::type type;
    SerializedPayload_t payload(100'000);
    ASSERT_TRUE(type.serialize(&vendor, &payload));
    const std::vector<std::uint8_t> expected(payload.data, payload.data + payload.length);
    ASSERT_EQ(ros::encode<ros::Wire::kCdr>(plain), expected);
    ASSERT_EQ(ros::encode<ros::Wire::kCdr>(ros::decode<Plain>(ros::Wire::kCdr, expected)), expected);
  }
}

}  // namespace
}  // namespace rtd::bus::fastdds
