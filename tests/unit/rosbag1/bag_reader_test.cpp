// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <numeric>

#include "common/ros_codec/wire.hpp"
#include "common/rosbag1/bag_reader.hpp"
#include "tests/support/rosbag1/bag_writer.hpp"

namespace rtd::rosbag1 {
namespace {

using test::bag_record;
using test::BagWriter;
using test::little_endian;
using test::TemporaryFile;
using namespace ::testing;

constexpr std::int64_t kSecond = 1'000'000'000;
const std::vector<std::string> kBoth = {"/a", "/b"};

std::vector<std::uint8_t> payload(int seed, std::size_t size = 5000) {
  std::vector<std::uint8_t> bytes(size);
  std::iota(bytes.begin(), bytes.end(), static_cast<std::uint8_t>(seed));
  return bytes;
}

/// Three chunks of two topics; the second message of /a is recorded late: it stands in the second chunk but is older.
BagWriter three_chunks(const std::string& compression) {
  BagWriter bag(compression);
  const auto a = bag.connection("/a", "std_msgs/A"), b = bag.connection("/b", "std_msgs/B");
  bag.message(a, 1 * kSecond, payload(1));
  bag.message(b, 3 * kSecond, payload(3));
  bag.end_chunk();
  bag.message(a, 2 * kSecond, payload(2));
  bag.end_chunk();
  bag.message(b, 4 * kSecond, payload(4));
  return bag;
}

/// The first bytes of the messages, in the order given; what cannot be read is -1.
std::vector<int> play(BagReader& reader, const std::vector<std::string>& topics = kBoth) {
  std::vector<int> firsts;
  for (const MessagePlace& place : reader.messages(topics)) {
    try {
      const Bytes bytes = reader.read(place);
      const std::vector<std::uint8_t> expected = payload(bytes[0]);
      firsts.push_back(std::equal(bytes.begin(), bytes.end(), expected.begin(), expected.end()) ? bytes[0] : -2);
    } catch (const BagError&) {
      firsts.push_back(-1);
    }
  }
  return firsts;
}

class Compressions : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, Compressions, testing::Values("none", "bz2", "lz4"));

TEST_P(Compressions, gives_messages_in_the_order_of_their_times) {
  const TemporaryFile file("x.bag", three_chunks(GetParam()).closed());
  BagReader reader(file.path());
  EXPECT_THAT(play(reader), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(play(reader, {"/b"}), ElementsAre(3, 4));
  EXPECT_THAT(reader.damages(), IsEmpty());
  EXPECT_TRUE(reader.indexed());
  ASSERT_THAT(reader.topics(), SizeIs(2));
  EXPECT_EQ(reader.topics()[1].name, "/b");
  EXPECT_EQ(reader.topics()[1].type, "std_msgs/B");
  EXPECT_EQ(reader.topics()[1].messages, 2U);
}

TEST_P(Compressions, reads_a_bag_that_was_never_closed) {
  const TemporaryFile file("x.bag", three_chunks(GetParam()).killed());
  BagReader reader(file.path());
  EXPECT_THAT(play(reader), ElementsAre(1, 2, 3, 4));
  EXPECT_FALSE(reader.indexed());
}

TEST_P(Compressions, cut_anywhere_gives_the_whole_chunks_before_the_cut) {
  const std::string whole = three_chunks(GetParam()).closed();
  std::size_t most = 0;
  for (std::size_t size = 0; size<whole.size(); size += whole.size()> 10000 ? 37 : 7) {
    const TemporaryFile file("x.bag", whole.substr(0, size));
    try {
      BagReader reader(file.path());
      const std::vector<int> read = play(reader);
      EXPECT_THAT(read, testing::Each(testing::Gt(0))) << "cut at " << size;
      EXPECT_GE(read.size(), most) << "cut at " << size;
      most = read.size();
    } catch (const BagError&) {
      EXPECT_LT(size, 4200U) << "only the version line and the bag header are indispensable";
    }
  }
  EXPECT_EQ(most, 4U);
}

TEST_P(Compressions, a_chunk_that_claims4_gb_is_refused_without_taking_the_memory) {
  std::string bytes = three_chunks(GetParam()).closed();
  const std::size_t size_field = bytes.find("size=");
  for (const std::uint64_t claim : {0xFFFFFFFFULL, 200ULL << 20U}) {
    bytes.replace(size_field + 5, 4, little_endian(claim, 4));
    const TemporaryFile file("x.bag", bytes);
    BagReader reader(file.path());
    EXPECT_THAT(play(reader), ElementsAre(-1, 2, -1, 4));
  }
}

TEST_P(Compressions, no_byte_flipped_crashes_the_reader) {
  const std::string sound = three_chunks(GetParam()).closed();
  std::uint32_t random = 1;
  for (int i = 0; i < 600; ++i) {
    std::string bytes = sound;
    for (int flips = 0; flips < 3; ++flips) {
      random = random * 1664525U + 1013904223U;
      const std::size_t span = i % 2 == 0 ? bytes.size() : 400;  // half of them into the first chunk's head
      bytes[(i % 2 == 0 ? 0 : 4100) + (random >> 8U) % (span - 20)] ^= static_cast<char>(1U << (random >> 29U));
    }
    const TemporaryFile file("x.bag", bytes);
    try {
      BagReader reader(file.path());
      play(reader);
    } catch (const BagError&) {
    }
  }
}

TEST(BagReader, refuses_what_is_no_bag_of_version2) {
  const auto open = [](const std::string& bytes) { BagReader reader(TemporaryFile("x.bag", bytes).path()); };
  EXPECT_THAT([] { BagReader("/nowhere/x.bag"); }, ThrowsMessage<BagError>(HasSubstr("cannot be read")));
  EXPECT_THAT([] { BagReader("/"); }, ThrowsMessage<BagError>(HasSubstr("this is a folder")));
  EXPECT_THAT([&] { open(""); }, ThrowsMessage<BagError>(HasSubstr("is not a ROS bag")));
  EXPECT_THAT([&] { open("\x89MCAP0\r\n and more of it"); }, ThrowsMessage<BagError>(HasSubstr("is not a ROS bag")));
  EXPECT_THAT([&] { open("#ROSBAG V1.2\nabc"); },
              ThrowsMessage<BagError>(AllOf(HasSubstr("version 1.2"), HasSubstr("rosbag fix"))));
  EXPECT_THAT([&] { open(BagWriter::kVersion); }, ThrowsMessage<BagError>(HasSubstr("ends in the middle")));
  EXPECT_THAT(
      [&] {
        open(BagWriter::kVersion + BagWriter::bag_header(0, {{"encryptor", "rosbag/AesCbcEncryptor"}}));
      },
      ThrowsMessage<BagError>(AllOf(HasSubstr("encrypted"), HasSubstr("rosbag decrypt"))));
}

TEST(BagReader, names_an_unknown_compression) {
  const TemporaryFile file("x.bag", three_chunks("zstd").closed());
  BagReader reader(file.path());
  EXPECT_THAT([&] { reader.read(reader.messages({"/a"})[0]); },
              ThrowsMessage<BagError>(AllOf(HasSubstr("'zstd'"), HasSubstr("none, bz2, lz4"))));
}

TEST(BagReader, a_message_longer_than_its_chunk_is_lost_alone) {
  std::string bytes = three_chunks("none").closed();
  const std::size_t length = bytes.find(little_endian(5000, 4) + '\x01' + '\x02');
  bytes.replace(length, 4, little_endian(50000, 4));
  const TemporaryFile file("x.bag", bytes);
  BagReader reader(file.path());
  EXPECT_THAT(play(reader), ElementsAre(-1, 2, 3, 4));
  EXPECT_THAT([&] { reader.read(reader.messages({"/a"})[0]); },
              ThrowsMessage<BagError>(AllOf(HasSubstr("50000 bytes are claimed"), HasSubstr("are left"))));
}

TEST(BagReader, an_index_that_lies_is_noticed) {
  std::string bytes = three_chunks("none").closed();
  const std::size_t index = bytes.find("op=\x04");
  const std::size_t offset = bytes.find(little_endian(1, 4) + little_endian(0, 4), index) + 8;
  bytes.replace(offset, 4, little_endian(7, 4));
  const TemporaryFile file("x.bag", bytes);
  BagReader reader(file.path());
  EXPECT_THAT(play(reader), ElementsAre(-1, 2, 3, 4));
}

TEST(BagReader, a_chunk_whose_index_is_damaged_is_searched) {
  std::string bytes = three_chunks("lz4").closed();
  bytes.replace(bytes.find(little_endian(10, 4) + "count=") + 10, 4, little_endian(7, 4));
  const TemporaryFile file("x.bag", bytes);
  BagReader reader(file.path());
  EXPECT_THAT(play(reader), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(reader.damages(), Contains(HasSubstr("index of 7 messages")));
}

}  // namespace
}  // namespace rtd::rosbag1

namespace rtd::ros {
namespace {

using namespace ::testing;

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
