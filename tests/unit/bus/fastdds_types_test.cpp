// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Our type support of Fast DDS against the one that fastddsgen makes of idl/.
#include <diagnostic_msgsPubSubTypes.h>
#include <geometry_msgsPubSubTypes.h>
#include <gtest/gtest.h>
#include <nav_msgsPubSubTypes.h>
#include <rcl_interfacesPubSubTypes.h>
#include <rmw_dds_commonPubSubTypes.h>
#include <rtd_msgsPubSubTypes.h>
#include <sensor_msgsPubSubTypes.h>
#include <tf2_msgsPubSubTypes.h>
#include <vision_msgsPubSubTypes.h>
#include <visualization_msgsPubSubTypes.h>

#include "common/bus/fastdds/codec.hpp"
#include "common/bus/fastdds/message_type.hpp"
#include "tests/unit/bus/recorded_samples.hpp"
#include "tests/unit/bus/ros_messages.hpp"

namespace rtd::bus::fastdds {
namespace {

using eprosima::fastdds::dds::TopicDataType;
using eprosima::fastrtps::rtps::SerializedPayload_t;

template <class Message, class GeneratedType>
struct Pair {
  using Ours = Message;
  using Generated = GeneratedType;
};

// clang-format off
using Pairs = testing::Types<
    Pair<msg::RgbdFrame, rtd_msgs::msg::dds_::RgbdFrame_PubSubType>,
    Pair<msg::RgbdFrame848, rtd_msgs::msg::dds_::RgbdFrame848_PubSubType>,
    Pair<msg::RgbdFrame1280, rtd_msgs::msg::dds_::RgbdFrame1280_PubSubType>,
    Pair<msg::RgbdFrame1920, rtd_msgs::msg::dds_::RgbdFrame1920_PubSubType>,
    Pair<msg::FeatureFrame, rtd_msgs::msg::dds_::FeatureFrame_PubSubType>,
    Pair<msg::KeyframeEvent, rtd_msgs::msg::dds_::KeyframeEvent_PubSubType>,
    Pair<msg::TrackingResult, rtd_msgs::msg::dds_::TrackingResult_PubSubType>,
    Pair<msg::ServiceStatus, rtd_msgs::msg::dds_::ServiceStatus_PubSubType>,
    Pair<msg::MapUpdate, rtd_msgs::msg::dds_::MapUpdate_PubSubType>,
    Pair<msg::Movers, rtd_msgs::msg::dds_::Movers_PubSubType>,
    Pair<msg::CompressedImage, sensor_msgs::msg::dds_::CompressedImage_PubSubType>,
    Pair<msg::Image, sensor_msgs::msg::dds_::Image_PubSubType>,
    Pair<msg::CameraInfo, sensor_msgs::msg::dds_::CameraInfo_PubSubType>,
    Pair<msg::Detection2DArray, vision_msgs::msg::dds_::Detection2DArray_PubSubType>,
    Pair<msg::Detection3DArray, vision_msgs::msg::dds_::Detection3DArray_PubSubType>,
    Pair<msg::MarkerArray, visualization_msgs::msg::dds_::MarkerArray_PubSubType>,
    Pair<msg::Odometry, nav_msgs::msg::dds_::Odometry_PubSubType>,
    Pair<msg::PoseStamped, geometry_msgs::msg::dds_::PoseStamped_PubSubType>,
    Pair<msg::TFMessage, tf2_msgs::msg::dds_::TFMessage_PubSubType>,
    Pair<msg::Path, nav_msgs::msg::dds_::Path_PubSubType>,
    Pair<msg::OccupancyGrid, nav_msgs::msg::dds_::OccupancyGrid_PubSubType>,
    Pair<msg::PointCloud2, sensor_msgs::msg::dds_::PointCloud2_PubSubType>,
    Pair<msg::DiagnosticArray, diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>>;
// clang-format on

/// An object of a type support.
struct Sample {
  explicit Sample(TopicDataType& its_type) : type(its_type), data(type.createData()) {}
  ~Sample() { type.deleteData(data); }
  TopicDataType& type;
  void* const data;
};

Cdr serialised(TopicDataType& type, void* data) {
  SerializedPayload_t payload(type.getSerializedSizeProvider(data)());
  EXPECT_TRUE(type.serialize(data, &payload));
  EXPECT_EQ(payload.encapsulation, CDR_LE);
  return {payload.data, payload.data + payload.length};
}

bool deserialised(TopicDataType& type, const Cdr& cdr, void* data) {
  SerializedPayload_t payload(static_cast<std::uint32_t>(cdr.size()));
  std::copy(cdr.begin(), cdr.end(), payload.data);
  payload.length = payload.max_size;
  return type.deserialize(&payload, data);
}

template <class T>
class FastddsTypes : public testing::Test {
 protected:
  MessageType<typename T::Ours> ours_;
  typename T::Generated generated_;
};
TYPED_TEST_SUITE(FastddsTypes, Pairs);

TYPED_TEST(FastddsTypes, announce_what_generated_code_does) {
  EXPECT_STREQ(this->ours_.getName(), this->generated_.getName());
  EXPECT_EQ(this->ours_.m_typeSize, this->generated_.m_typeSize);
  EXPECT_EQ(this->ours_.m_isGetKeyDefined, this->generated_.m_isGetKeyDefined);
  EXPECT_EQ(this->ours_.is_bounded(), this->generated_.is_bounded());
  EXPECT_EQ(this->ours_.type_object(), this->generated_.type_object());
  EXPECT_EQ(this->ours_.type_information(), this->generated_.type_information());
  using Ours = typename TypeParam::Ours;
  EXPECT_EQ(this->ours_.m_typeSize, recorded_samples(MessageTraits<Ours>::kId).largest_sample);
  const auto codec = create_codec(MessageTraits<Ours>::kId);
  EXPECT_EQ(codec->create_type().get_type_name(), this->generated_.getName());
  EXPECT_EQ(codec->plain(), this->generated_.is_bounded());
}

TYPED_TEST(FastddsTypes, give_the_recorded_bytes) {
  using Ours = typename TypeParam::Ours;
  expect_recorded_bytes<Ours>(
      [this](const Ours& message) { return serialised(this->ours_, const_cast<Ours*>(&message)); });
}

TYPED_TEST(FastddsTypes, write_and_read_the_bytes_of_generated_code) {
  using Ours = typename TypeParam::Ours;
  std::mt19937_64 random(9);
  for (int number = 0; number < (MessageTraits<Ours>::kPlain ? 3 : 100); ++number) {
    const auto message = make_message<Ours>(number, random), back = std::make_unique<Ours>();
    const Cdr cdr = serialised(this->ours_, message.get());
    Sample sample(this->generated_);
    ASSERT_TRUE(deserialised(this->generated_, cdr, sample.data));
    const Cdr generated_cdr = serialised(this->generated_, sample.data);
    ASSERT_EQ(generated_cdr, cdr);
    ASSERT_TRUE(deserialised(this->ours_, generated_cdr, back.get()));
    ASSERT_EQ(serialised(this->ours_, back.get()), cdr);
  }
}

TYPED_TEST(FastddsTypes, refuse_bytes_cut_short_and_absurd_lengths) {
  using Ours = typename TypeParam::Ours;
  std::mt19937_64 random(9);
  const auto message = make_message<Ours>(1, random), received = std::make_unique<Ours>();
  Cdr whole = serialised(this->ours_, message.get());
  for (const std::size_t length : {whole.size() - 1, whole.size() / 2, std::size_t{5}, std::size_t{3}}) {
    EXPECT_FALSE(deserialised(this->ours_, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)},
                                    received.get()))
        << length << " of " << whole.size() << " bytes";
  }
  if (!this->ours_.is_plain()) {
    std::fill(whole.begin() + 4, whole.end(), 0xff);  // every length is 4 billion
    EXPECT_FALSE(deserialised(this->ours_, whole, received.get()));
  }
  whole[1] = 0;  // big endian
  EXPECT_FALSE(deserialised(this->ours_, whole, received.get()));
}

template <class Ours, class Generated>
void expect_same_ros_bytes() {
  Generated generated;
  std::mt19937_64 random(9);
  for (int number = 0; number < 100; ++number) {
    const Cdr cdr = ros::encode<ros::Wire::kCdr>(reflect::random_ros_message<Ours>(random));
    Sample sample(generated);
    ASSERT_TRUE(deserialised(generated, cdr, sample.data)) << generated.getName();
    ASSERT_EQ(serialised(generated, sample.data), cdr) << generated.getName();
  }
}

TEST(FastddsTypesOfRos, parameters_and_nodes_have_the_bytes_of_generated_code) {
  using namespace rcl_interfaces::srv::dds_;
  using namespace rmw_dds_common::msg::dds_;
  expect_same_ros_bytes<msg::ListParametersRequest, ListParameters_Request_PubSubType>();
  expect_same_ros_bytes<msg::ListParametersReply, ListParameters_Response_PubSubType>();
  expect_same_ros_bytes<msg::ParameterNames, GetParameters_Request_PubSubType>();
  expect_same_ros_bytes<msg::GetParametersReply, GetParameters_Response_PubSubType>();
  expect_same_ros_bytes<msg::GetParameterTypesReply, GetParameterTypes_Response_PubSubType>();
  expect_same_ros_bytes<msg::DescribeParametersReply, DescribeParameters_Response_PubSubType>();
  expect_same_ros_bytes<msg::ParameterList, SetParameters_Request_PubSubType>();
  expect_same_ros_bytes<msg::SetParametersReply, SetParameters_Response_PubSubType>();
  expect_same_ros_bytes<msg::SetParametersAtomicallyReply, SetParametersAtomically_Response_PubSubType>();
  expect_same_ros_bytes<msg::ParticipantEntitiesInfo<16>, ParticipantEntitiesInfo_PubSubType>();
  expect_same_ros_bytes<msg::ParticipantEntitiesInfo<24>, ParticipantEntitiesInfo24_PubSubType>();
}

}  // namespace
}  // namespace rtd::bus::fastdds
