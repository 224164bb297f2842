// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// common/ros_codec against the code that was generated from idl/.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>

#include "common/bus/fastdds/converted_type.hpp"
#include "common/bus/fastdds/plain_type.hpp"
#include "common/bus/message_types.hpp"
#include "common/ros_codec/wire_reader.hpp"
#include "common/ros_codec/wire_rtd.hpp"
#include "common/ros_codec/wire_writer.hpp"
#include "tests/unit/bus/random_message.hpp"

namespace rtd::bus::fastdds {
namespace {

using eprosima::fastrtps::rtps::SerializedPayload_t;
using Cdr = std::vector<std::uint8_t>;

template <class T>
class VariableCdr : public testing::Test {};
using VariableMessages =
    testing::Types<msg::ServiceStatus, msg::CompressedImage, msg::Image, msg::CameraInfo, msg::Detection2DArray,
                   msg::Odometry, msg::PoseStamped, msg::TFMessage, msg::Path, msg::PointCloud2, msg::DiagnosticArray>;
TYPED_TEST_SUITE(VariableCdr, VariableMessages);

template <class T>
class PlainCdr : public testing::Test {};
using PlainMessages = testing::Types<msg::RgbdFrame, msg::FeatureFrame, msg::KeyframeEvent, msg::TrackingResult>;
TYPED_TEST_SUITE(PlainCdr, PlainMessages);

/// The bytes of the generated serialiser.
template <class Plain>
Cdr generated_bytes(const Plain& plain) {
  VendorOf<Plain> vendor;
  ToVendor()(plain, vendor);
  typename ConvertedType<Plain>::PubSub type;
  SerializedPayload_t payload(100'000);
  EXPECT_TRUE(type.serialize(&vendor, &payload));
  return {payload.data, payload.data + payload.length};
}

/// Whether the bytes are read as a message; anything else than WireError fails the test.
template <class Plain>
bool is_read(ros::Bytes bytes) {
  try {
    ros::decode<Plain>(ros::Wire::kCdr, bytes);
    return true;
  } catch (const ros::WireError&) {
    return false;
  }
}

TYPED_TEST(VariableCdr, gives_and_reads_the_bytes_of_the_generated_serialiser) {
  std::mt19937_64 random(9);
  for (int i = 0; i < 100; ++i) {
    TypeParam plain;
    if (i > 0) reflect::randomize(plain, random);  // the first one is empty
    const Cdr expected = generated_bytes(plain);
    ASSERT_EQ(ros::encode<ros::Wire::kCdr>(plain), expected);
    ASSERT_EQ(ros::encoded_size<ros::Wire::kCdr>(plain), expected.size());
    const auto read = ros::decode<TypeParam>(ros::Wire::kCdr, expected);
    ASSERT_EQ(ros::encode<ros::Wire::kCdr>(read), expected);
    ASSERT_EQ(reflect::fingerprint(read), reflect::fingerprint(plain));
  }
}

TYPED_TEST(VariableCdr, is_refused_when_cut_anywhere) {
  std::mt19937_64 random(10);
  TypeParam plain;
  reflect::randomize(plain, random);
  const Cdr whole = ros::encode<ros::Wire::kCdr>(plain);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(is_read<TypeParam>(ros::Bytes(whole).first(size))) << size;
  }
}

TYPED_TEST(VariableCdr, survives_any_change_of_its_bytes) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 1000; ++i) {
    TypeParam plain;
    reflect::randomize(plain, random);
    Cdr bytes = ros::encode<ros::Wire::kCdr>(plain);
    const std::size_t at = random() % bytes.size();
    const bool absurd_length = random() % 2 == 0;
    for (std::size_t k = at; k < std::min(at + (absurd_length ? 4 : 1), bytes.size()); ++k) {
      bytes[k] = absurd_length ? 0xFF : static_cast<std::uint8_t>(random());
    }
    is_read<TypeParam>(bytes);  // either way, but no crash, no other exception, no giant allocation
  }
}

TYPED_TEST(PlainCdr, gives_and_reads_what_lies_in_memory) {
  std::mt19937_64 random(12);
  auto plain = std::make_unique<TypeParam>();
  auto* const memory = reinterpret_cast<std::uint8_t*>(plain.get());
  std::generate_n(memory, sizeof(TypeParam), [&] { return static_cast<std::uint8_t>(random() % 64); });
  const Cdr cdr = ros::encode<ros::Wire::kCdr>(*plain);
  SerializedPayload_t expected(PlainType<TypeParam>::kWireBytes);
  ASSERT_TRUE(PlainType<TypeParam>("name").serialize(plain.get(), &expected));
  ASSERT_EQ(cdr.size(), expected.length);
  EXPECT_TRUE(std::equal(cdr.begin(), cdr.end(), expected.data));

  auto read = std::make_unique<TypeParam>();
  ros::WireReader<ros::Wire::kCdr> reader(cdr);
  reader(*read);
  EXPECT_EQ(std::memcmp(read.get(), plain.get(), sizeof(TypeParam)), 0);
}

TEST(Cdr, of_a_large_image_is_taken_in_one_piece) {
  msg::Image image;
  image.data.resize(8 << 20, 7);
  const Cdr cdr = ros::encode<ros::Wire::kCdr>(image);
  EXPECT_EQ(cdr.capacity(), cdr.size()) << "reserved at once";
  EXPECT_EQ(ros::decode<msg::Image>(ros::Wire::kCdr, cdr).data, image.data);
}

TEST(Cdr, of_a_string_without_end_mark_is_refused) {
  Cdr cdr = ros::encode<ros::Wire::kCdr>(msg::Header{{1, 2}, "map"});
  cdr.back() = 'x';
  EXPECT_FALSE(is_read<msg::Header>(cdr));
}

}  // namespace
}  // namespace rtd::bus::fastdds
