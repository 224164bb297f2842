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

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/fastdds/codec.hpp"
#include "common/bus/fastdds/message_type.hpp"
#include "common/bus/fastdds/versions/vendor.hpp"
#include "tests/unit/bus/recorded_samples.hpp"
#include "tests/unit/bus/ros_messages.hpp"

namespace rtd::bus::fastdds {
namespace {

/// A type support, ours or a generated one, by the interface of the version of Fast DDS that is installed.
class AnyType {
 public:
  using Bytes = std::vector<std::uint8_t>;
  explicit AnyType(dds::TopicDataType& type) : type_(type) {}

  bool bounded() const { return type_.is_bounded(); }

#if __has_include(<fastrtps/fastrtps_dll.h>)
  /// Whether generated code counts 100 elements for a sequence without a bound, or none.
  static constexpr bool kGeneratedCountsUnbounded = true;
  static constexpr std::uint32_t kRounding = 0;  ///< bytes that generated code may add to the largest sample
  std::string name() const {
    return type_.getName();
  }
  std::uint32_t largest() const {
    return type_.m_typeSize;
  }
  bool keyed() const {
    return type_.m_isGetKeyDefined;
  }
  bool describes_itself() const {
    return type_.type_object() != nullptr || type_.type_information() != nullptr;
  }
  void* create() {
    return type_.createData();
  }
  void destroy(void* data) {
    type_.deleteData(data);
  }
  Bytes serialised(void* data) {
    rtps::SerializedPayload_t payload(type_.getSerializedSizeProvider(data)());
    return checked(type_.serialize(data, &payload), payload);
  }
  bool deserialised(const Bytes& cdr, void* data) {
    rtps::SerializedPayload_t payload = payload_of(cdr);
    return type_.deserialize(&payload, data);
  }
#else
  static constexpr bool kGeneratedCountsUnbounded = false;
  static constexpr std::uint32_t kRounding = 4;
  std::string name() const {
    return type_.get_name();
  }
  std::uint32_t largest() const {
    return type_.max_serialized_type_size;
  }
  bool keyed() const {
    return type_.is_compute_key_provided;
  }
  bool describes_itself() const {
    return type_.type_identifiers().type_identifier1()._d() != dds::xtypes::TK_NONE;
  }
  void* create() {
    return type_.create_data();
  }
  void destroy(void* data) {
    type_.delete_data(data);
  }
  Bytes serialised(void* data) {
    rtps::SerializedPayload_t payload(type_.calculate_serialized_size(data, dds::XCDR_DATA_REPRESENTATION));
    return checked(type_.serialize(data, payload, dds::XCDR_DATA_REPRESENTATION), payload);
  }
  bool deserialised(const Bytes& cdr, void* data) {
    rtps::SerializedPayload_t payload = payload_of(cdr);
    return type_.deserialize(payload, data);
  }
#endif

 private:
  static Bytes checked(bool written, const rtps::SerializedPayload_t& payload) {
    if (!written || payload.encapsulation != CDR_LE) throw std::runtime_error("not serialised as little-endian CDR");
    return {payload.data, payload.data + payload.length};
  }
  static rtps::SerializedPayload_t payload_of(const Bytes& cdr) {
    rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(cdr.size()));
    std::copy(cdr.begin(), cdr.end(), payload.data);
    payload.length = payload.max_size;
    return payload;
  }

  dds::TopicDataType& type_;
};

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
    Pair<msg::KeyframeFeatures, rtd_msgs::msg::dds_::KeyframeFeatures_PubSubType>,
    Pair<msg::KeyframeRequest, rtd_msgs::msg::dds_::KeyframeRequest_PubSubType>,
    Pair<msg::Submap, rtd_msgs::msg::dds_::Submap_PubSubType>,
    Pair<msg::AtlasState, rtd_msgs::msg::dds_::AtlasState_PubSubType>,
    Pair<msg::CompressedImage, sensor_msgs::msg::dds_::CompressedImage_PubSubType>,
    Pair<msg::Image, sensor_msgs::msg::dds_::Image_PubSubType>,
    Pair<msg::CameraInfo, sensor_msgs::msg::dds_::CameraInfo_PubSubType>,
    Pair<msg::Detection2DArray, vision_msgs::msg::dds_::Detection2DArray_PubSubType>,
    Pair<msg::Detection3DArray, vision_msgs::msg::dds_::Detection3DArray_PubSubType>,
    Pair<msg::MarkerArray, visualization_msgs::msg::dds_::MarkerArray_PubSubType>,
    Pair<msg::Odometry, nav_msgs::msg::dds_::Odometry_PubSubType>,
    Pair<msg::PoseArray, geometry_msgs::msg::dds_::PoseArray_PubSubType>,
    Pair<msg::PoseStamped, geometry_msgs::msg::dds_::PoseStamped_PubSubType>,
    Pair<msg::TFMessage, tf2_msgs::msg::dds_::TFMessage_PubSubType>,
    Pair<msg::TransformStamped, geometry_msgs::msg::dds_::TransformStamped_PubSubType>,
    Pair<msg::Path, nav_msgs::msg::dds_::Path_PubSubType>,
    Pair<msg::OccupancyGrid, nav_msgs::msg::dds_::OccupancyGrid_PubSubType>,
    Pair<msg::PointCloud2, sensor_msgs::msg::dds_::PointCloud2_PubSubType>,
    Pair<msg::DiagnosticArray, diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>>;
// clang-format on

/// An object of a type support.
struct Sample {
  explicit Sample(AnyType its_type) : type(its_type), data(type.create()) {}
  ~Sample() { type.destroy(data); }
  AnyType type;
  void* const data;
};

template <class T>
class FastddsTypes : public testing::Test {
 protected:
  MessageType<typename T::Ours> our_type_;
  typename T::Generated generated_type_;
  AnyType ours_{our_type_}, generated_{generated_type_};
};
TYPED_TEST_SUITE(FastddsTypes, Pairs);

TYPED_TEST(FastddsTypes, announce_what_generated_code_does) {
  EXPECT_EQ(this->ours_.name(), this->generated_.name());
  if (AnyType::kGeneratedCountsUnbounded || this->generated_.bounded()) {
    EXPECT_LE(this->ours_.largest(), this->generated_.largest());
    EXPECT_GE(this->ours_.largest() + AnyType::kRounding, this->generated_.largest());
  }
  EXPECT_EQ(this->ours_.keyed(), this->generated_.keyed());
  EXPECT_EQ(this->ours_.bounded(), this->generated_.bounded());
  EXPECT_FALSE(this->ours_.describes_itself()) << "types match by name, in all versions";
  using Ours = typename TypeParam::Ours;
  EXPECT_EQ(this->ours_.largest(), recorded_samples(MessageTraits<Ours>::kId).largest_sample);
  const auto codec = create_codec(MessageTraits<Ours>::kId);
  EXPECT_EQ(codec->create_type().get_type_name(), this->generated_.name());
  EXPECT_EQ(codec->plain(), this->generated_.bounded());
}

TYPED_TEST(FastddsTypes, give_the_recorded_bytes) {
  using Ours = typename TypeParam::Ours;
  expect_recorded_bytes<Ours>(
      [this](const Ours& message) { return this->ours_.serialised(const_cast<Ours*>(&message)); });
}

TYPED_TEST(FastddsTypes, write_and_read_the_bytes_of_generated_code) {
  using Ours = typename TypeParam::Ours;
  std::mt19937_64 random(9);
  for (int number = 0; number < (MessageTraits<Ours>::kPlain ? 3 : 100); ++number) {
    const auto message = make_message<Ours>(number, random), back = std::make_unique<Ours>();
    const Cdr cdr = this->ours_.serialised(message.get());
    Sample sample(this->generated_);
    ASSERT_TRUE(this->generated_.deserialised(cdr, sample.data));
    const Cdr generated_cdr = this->generated_.serialised(sample.data);
    ASSERT_EQ(generated_cdr, cdr);
    ASSERT_TRUE(this->ours_.deserialised(generated_cdr, back.get()));
    ASSERT_EQ(this->ours_.serialised(back.get()), cdr);
  }
}

TYPED_TEST(FastddsTypes, refuse_bytes_cut_short_and_absurd_lengths) {
  using Ours = typename TypeParam::Ours;
  std::mt19937_64 random(9);
  const auto message = make_message<Ours>(1, random), received = std::make_unique<Ours>();
  Cdr whole = this->ours_.serialised(message.get());
  for (const std::size_t length : {whole.size() - 1, whole.size() / 2, std::size_t{5}, std::size_t{3}}) {
    EXPECT_FALSE(
        this->ours_.deserialised({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)}, received.get()))
        << length << " of " << whole.size() << " bytes";
  }
  if (!this->ours_.bounded()) {
    std::fill(whole.begin() + 4, whole.end(), 0xff);  // every length is 4 billion
    EXPECT_FALSE(this->ours_.deserialised(whole, received.get()));
  }
  whole[1] = 0;  // big endian
  EXPECT_FALSE(this->ours_.deserialised(whole, received.get()));
}

template <class Ours, class Generated>
void expect_same_ros_bytes() {
  Generated type;
  AnyType generated(type);
  std::mt19937_64 random(9);
  for (int number = 0; number < 100; ++number) {
    const Cdr cdr = ros::encode<ros::Wire::kCdr>(reflect::random_ros_message<Ours>(random));
    Sample sample(generated);
    ASSERT_TRUE(generated.deserialised(cdr, sample.data)) << generated.name();
    ASSERT_EQ(generated.serialised(sample.data), cdr) << generated.name();
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
