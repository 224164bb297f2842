// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// The plain structs of common/msg go over the wire as they lie in memory. These tests hold them against the code that
// was generated from idl/rtd_msgs.idl.
#include <gtest/gtest.h>
#include <rtd_msgsPubSubTypes.h>

#include <cstring>
#include <memory>
#include <random>

#include "common/bus/fastdds/codec.hpp"
#include "common/bus/fastdds/plain_type.hpp"

namespace rtd::bus::fastdds {
namespace {

using eprosima::fastrtps::rtps::SerializedPayload_t;
namespace idl = rtd_msgs::msg::dds_;

template <class Plain, class Generated, class GeneratedType>
struct Pair {
  using plain = Plain;
  using generated = Generated;
  using type = GeneratedType;
};

template <class T>
class PlainLayout : public testing::Test {};
using PlainMessages = testing::Types<Pair<msg::RgbdFrame, idl::RgbdFrame_, idl::RgbdFrame_PubSubType>,
                                     Pair<msg::FeatureFrame, idl::FeatureFrame_, idl::FeatureFrame_PubSubType>,
                                     Pair<msg::KeyframeEvent, idl::KeyframeEvent_, idl::KeyframeEvent_PubSubType>,
                                     Pair<msg::TrackingResult, idl::TrackingResult_, idl::TrackingResult_PubSubType>>;
TYPED_TEST_SUITE(PlainLayout, PlainMessages);

TYPED_TEST(PlainLayout, has_the_size_of_the_idl_in_memory_and_on_the_wire) {
  using Plain = typename TypeParam::plain;
  EXPECT_EQ(sizeof(Plain), sizeof(typename TypeParam::generated));
  EXPECT_EQ(sizeof(Plain), TypeParam::generated::getMaxCdrSerializedSize());
}

TYPED_TEST(PlainLayout, gives_the_bytes_of_the_generated_serialiser) {
  using Plain = typename TypeParam::plain;
  auto message = std::make_unique<typename TypeParam::generated>();
  std::mt19937_64 random(3);
  auto* bytes = reinterpret_cast<std::uint8_t*>(message.get());
  for (std::size_t i = 0; i < sizeof(Plain); ++i) bytes[i] = static_cast<std::uint8_t>(random());

  typename TypeParam::type generated_type;
  PlainType<Plain> plain_type("name");
  SerializedPayload_t generated(static_cast<std::uint32_t>(sizeof(Plain)) + 4), plain(generated.max_size);
  ASSERT_TRUE(generated_type.serialize(message.get(), &generated));
  ASSERT_TRUE(plain_type.serialize(message.get(), &plain));
  ASSERT_EQ(plain.length, generated.length);
  EXPECT_EQ(std::memcmp(plain.data, generated.data, plain.length), 0);
}

TYPED_TEST(PlainLayout, has_the_name_of_the_idl) {
  const auto codec = create_codec(MessageTraits<typename TypeParam::plain>::kId);
  EXPECT_EQ(codec->create_type().get_type_name(), typename TypeParam::type().getName());
}

TYPED_TEST(PlainLayout, comes_back_as_it_was_and_refuses_what_is_short_or_big_endian) {
  using Plain = typename TypeParam::plain;
  PlainType<Plain> type("name");
  SerializedPayload_t payload(PlainType<Plain>::kWireBytes);
  auto sent = std::make_unique<Plain>(), received = std::make_unique<Plain>();
  std::memset(static_cast<void*>(sent.get()), 0x5a, sizeof(Plain));
  ASSERT_TRUE(type.serialize(sent.get(), &payload));
  ASSERT_TRUE(type.deserialize(&payload, received.get()));
  EXPECT_EQ(std::memcmp(sent.get(), received.get(), sizeof(Plain)), 0);

  payload.length -= 1;
  EXPECT_FALSE(type.deserialize(&payload, received.get()));
  payload.length += 1;
  payload.data[1] = 0;
  EXPECT_FALSE(type.deserialize(&payload, received.get()));
}

template <class Generated, class Plain>
std::unique_ptr<Generated> bytes_as(const Plain& plain) {
  static_assert(sizeof(Generated) == sizeof(Plain));
  auto generated = std::make_unique<Generated>();
  std::memcpy(static_cast<void*>(generated.get()), &plain, sizeof(plain));
  return generated;
}

/// Bytes alone would not notice two fields of one size that changed places.
TEST(PlainLayoutFields, lie_where_the_idl_has_them) {
  auto frame = std::make_unique<msg::RgbdFrame>();
  std::memset(static_cast<void*>(frame.get()), 0, sizeof(*frame));
  frame->seq = 1;
  frame->stamp_ns = 2;
  frame->published_ns = 3;
  frame->intrinsics[3] = 4;
  frame->distortion[4] = 5;
  frame->depth_scale_m = 6;
  frame->width = 7;
  frame->height = 8;
  frame->source_id = 9;
  frame->color_bgr.back() = 10;
  frame->depth.back() = 11;
  const auto same_owner = bytes_as<idl::RgbdFrame_>(*frame);
  const auto& same = *same_owner;
  EXPECT_EQ(same.seq(), 1U);
  EXPECT_EQ(same.stamp_ns(), 2);
  EXPECT_EQ(same.published_ns(), 3);
  EXPECT_EQ(same.intrinsics()[3], 4);
  EXPECT_EQ(same.distortion()[4], 5);
  EXPECT_EQ(same.depth_scale_m(), 6);
  EXPECT_EQ(same.width(), 7U);
  EXPECT_EQ(same.height(), 8U);
  EXPECT_EQ(same.source_id(), 9U);
  EXPECT_EQ(same.color_bgr().back(), 10);
  EXPECT_EQ(same.depth().back(), 11);
}

TEST(PlainLayoutFields, of_features_lie_where_the_idl_has_them) {
  auto frame = std::make_unique<msg::FeatureFrame>();
  std::memset(static_cast<void*>(frame.get()), 0, sizeof(*frame));
  frame->width = 1;
  frame->height = 2;
  frame->count = 3;
  frame->removed = 4;
  frame->objects = 5;
  frame->detection_use = msg::DetectionUse::kDetectorGone;
  frame->stage_ms[7] = 7;
  frame->features.back() = {1, 2, 3, 4, 5, 6, 7, 8, 9, -10, {}};
  frame->features.back().descriptor[31] = 11;
  const auto same_owner = bytes_as<idl::FeatureFrame_>(*frame);
  const auto& same = *same_owner;
  EXPECT_EQ(same.width(), 1U);
  EXPECT_EQ(same.height(), 2U);
  EXPECT_EQ(same.count(), 3U);
  EXPECT_EQ(same.removed(), 4U);
  EXPECT_EQ(same.objects(), 5U);
  EXPECT_EQ(same.detection_use(), 3U);
  EXPECT_EQ(same.stage_ms()[7], 7);
  const idl::Feature_& feature = same.features().back();
  EXPECT_EQ(feature.u_px(), 1);
  EXPECT_EQ(feature.v_px(), 2);
  EXPECT_EQ(feature.u_raw_px(), 3);
  EXPECT_EQ(feature.v_raw_px(), 4);
  EXPECT_EQ(feature.depth_m(), 5);
  EXPECT_EQ(feature.angle_rad(), 6);
  EXPECT_EQ(feature.static_probability(), 7);
  EXPECT_EQ(feature.octave(), 8);
  EXPECT_EQ(feature.flags(), 9);
  EXPECT_EQ(feature.object_id(), -10);
  EXPECT_EQ(feature.descriptor()[31], 11);
}

TEST(PlainLayoutFields, of_tracking_and_keyframes_lie_where_the_idl_has_them) {
  msg::TrackingResult result{};
  result.finished_ns = 1;
  result.T_world_camera.translation_m[2] = 2;
  result.T_world_camera.rotation_xyzw[3] = 3;
  result.covariance[35] = 4;
  result.event_count = 5;
  result.state = msg::TrackingState::kLost;
  result.inliers = 7;
  result.features_static = 8;
  result.features_removed = 9;
  result.keyframes = 10;
  result.landmarks = 11;
  result.map_id = 12;
  result.maps = 13;
  const auto same_owner = bytes_as<idl::TrackingResult_>(result);
  const auto& same = *same_owner;
  EXPECT_EQ(same.finished_ns(), 1);
  EXPECT_EQ(same.T_world_camera().translation_m()[2], 2);
  EXPECT_EQ(same.T_world_camera().rotation_xyzw()[3], 3);
  EXPECT_EQ(same.covariance()[35], 4);
  EXPECT_EQ(same.event_count(), 5U);
  EXPECT_EQ(same.state(), 3U);
  EXPECT_EQ(same.inliers(), 7U);
  EXPECT_EQ(same.features_static(), 8U);
  EXPECT_EQ(same.features_removed(), 9U);
  EXPECT_EQ(same.keyframes(), 10U);
  EXPECT_EQ(same.landmarks(), 11U);
  EXPECT_EQ(same.map_id(), 12U);
  EXPECT_EQ(same.maps(), 13U);

  msg::KeyframeEvent event{};
  event.event_index = 1;
  event.frame_seq = 2;
  event.stamp_ns = 3;
  event.keyframe_id = 4;
  event.kind = msg::KeyframeEventKind::kRemoved;
  const auto same_event_owner = bytes_as<idl::KeyframeEvent_>(event);
  const auto& same_event = *same_event_owner;
  EXPECT_EQ(same_event.event_index(), 1U);
  EXPECT_EQ(same_event.frame_seq(), 2U);
  EXPECT_EQ(same_event.stamp_ns(), 3);
  EXPECT_EQ(same_event.keyframe_id(), 4U);
  EXPECT_EQ(same_event.kind(), 2U);
}

}  // namespace
}  // namespace rtd::bus::fastdds
