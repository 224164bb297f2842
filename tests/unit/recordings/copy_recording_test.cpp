// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/copy_recording.hpp"

#include "common/msg/ros.hpp"
#include "common/ros2/ros1_to_cdr.hpp"
#include "common/ros2/type_description.hpp"
#include "common/ros_codec/message_definition.hpp"
#include "common/ros_codec/wire.hpp"
#include "tests/support/rosbag1/bag_writer.hpp"
#include "tests/unit/recordings/sample_files.hpp"

namespace rtd::recordings {
namespace {

using test::Folder;
using test::messages_of;
using test::Sample;
using test::samples;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr char kHeader[] = "================\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";

/// The message in CDR, made from its ROS 1 form by its definition.
template <class Message>
std::vector<std::uint8_t> transcribed(const Message& message, const std::string& type, const std::string& definition) {
  const ros2::Ros1ToCdr to_cdr(type, ros::parse_definition(type, definition));
  return to_cdr(ros::encode<ros::Wire::kRos1>(message));
}

TEST(Ros1ToCdr, gives_the_bytes_that_ros2_would_write) {
  msg::Image image;
  image.header = {{7, 8}, "camera"};
  image.height = 2;
  image.width = 3;
  image.step = 3;
  image.encoding = "mono8";
  image.data = {1, 2, 3, 4, 5, 6};
  EXPECT_EQ(transcribed(image, "sensor_msgs/Image",
                        std::string("Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n"
                                    "uint32 step\nuint8[] data\n") +
                            kHeader),
            ros::encode<ros::Wire::kCdr>(image));
  msg::CameraInfo info;
  info.header.frame_id = "abc";
  info.distortion_model = "plumb_bob";
  info.d = {0.1, 0.2, 0.3};
  info.k = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  info.width = 640;
  EXPECT_EQ(transcribed(info, "sensor_msgs/CameraInfo",
                        std::string("Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] D\n"
                                    "float64[9] K\nfloat64[9] R\nfloat64[12] P\nuint32 binning_x\nuint32 binning_y\n"
                                    "RegionOfInterest roi\n") +
                            kHeader +
                            "===\nMSG: sensor_msgs/RegionOfInterest\nuint32 x_offset\nuint32 y_offset\nuint32 height\n"
                            "uint32 width\nbool do_rectify\n"),
            ros::encode<ros::Wire::kCdr>(info));
}

TEST(Ros1ToCdr, definitions_become_those_of_ros2) {
  const std::string definition = std::string("Header header\nfloat64[9] K\nduration sinceStart\nchar c\n") + kHeader;
  const ros::MessageFields types = ros2::as_ros2(ros::parse_definition("a_msgs/A", definition));
  const std::string text = ros2::ros2msg_text("a_msgs/A", types);
  EXPECT_THAT(text,
              HasSubstr("std_msgs/Header header\nfloat64[9] k\nbuiltin_interfaces/Duration since_start\nuint8 c\n"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("seq")));
  EXPECT_THAT(text, HasSubstr("MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"));
}

TEST(Ros1ToCdr, messages_that_are_no_such_message_are_refused) {
  const auto types = ros::parse_definition(
      "a_msgs/A", "string[] names\nfloat64[4] values\nB[] b\n===\nMSG: a_msgs/B\nint8 x=1\nint8 y");
  const ros2::Ros1ToCdr to_cdr("a_msgs/A", types);
  std::vector<std::uint8_t> whole(4 + 4 + 2 + 32 + 4 + 3, 0);
  whole[0] = 1;
  whole[4] = 2;
  whole[42] = 3;
  EXPECT_EQ(to_cdr(whole).size(), 4U + 4 + 4 + 3 + 5 + 32 + 4 + 3);
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    EXPECT_THROW(to_cdr(ros::Bytes(whole).first(bytes)), ros::WireError) << bytes;
  }
  whole.push_back(0);
  EXPECT_THROW(to_cdr(whole), ros::WireError) << "bytes left behind";
  whole.assign(8, 0xff);
  EXPECT_THROW(to_cdr(whole), ros::WireError) << "four billion names";
}

class CopyRecordingTest : public ::testing::Test {
 protected:
  CopiedRecording copy(const std::string& source) {
    return copy_recording(open(source), folder_ / "new.mcap", mcap::Compression::kZstd, nullptr, [](std::uint64_t) {});
  }
  std::vector<Sample> copied() { return messages_of(*open(folder_ / "new.mcap").source); }

  Folder folder_;
};

TEST_F(CopyRecordingTest, a_database_is_carried_byte_for_byte_with_every_topic) {
  const CopiedRecording result = copy(folder_.db3("a.db3", samples(0, 8)));
  EXPECT_EQ(result.messages, 8U);
  EXPECT_EQ(result.topics, 2U);
  EXPECT_EQ(result.from_ros1, 0U);
  EXPECT_THAT(result.damages, IsEmpty());
  EXPECT_EQ(copied(), samples(0, 8));
}

TEST_F(CopyRecordingTest, a_bag_is_turned_into_cdr_and_what_cannot_be_is_named) {
  rtd::test::BagWriter bag;
  const std::string definition = std::string("Header header\nfloat64 value\n") + kHeader;
  const std::uint32_t good = bag.connection("/good", "a_msgs/Value", definition);
  const std::uint32_t bad = bag.connection("/bad", "a_msgs/Other", "Missing m\n");
  std::vector<std::uint8_t> bytes = {9, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0, 'f'};
  bytes.insert(bytes.end(), 8, 0x40);
  bag.message(good, 1'000'000'000, bytes);
  bag.message(bad, 1'000'000'001, bytes);
  bytes.pop_back();
  bag.message(good, 1'000'000'002, bytes);
  const CopiedRecording result = copy(folder_.write("a.bag", bag.closed()));
  EXPECT_EQ(result.messages, 1U);
  EXPECT_EQ(result.from_ros1, 1U);
  ASSERT_TRUE(result.left_out.contains("/bad"));
  EXPECT_THAT(result.left_out.at("/bad"), HasSubstr("Missing"));
  EXPECT_THAT(result.damages, ElementsAre(HasSubstr("a message of /good is left out")));
  const std::string cdr = {0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 'f', 0, 0, 0};
  EXPECT_THAT(copied(), ElementsAre(Sample{"/good", 1'000'000'000, cdr + std::string(8, '\x40')}));
}

TEST_F(CopyRecordingTest, nothing_is_overwritten) {
  folder_.write("new.mcap", "mine");
  const std::string source = folder_.mcap("a.mcap", samples(0, 2));
  EXPECT_THROW(copy(source), io::IoError);
  EXPECT_EQ(rtd::test::read_text(folder_ / "new.mcap"), "mine");
}

}  // namespace
}  // namespace rtd::recordings
