// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros_codec/message_definition.hpp"

#include <gmock/gmock.h>

namespace rtd::ros {
namespace {

using namespace ::testing;
using Kind = MessageField::Kind;

constexpr char kOdometry[] = R"(# An estimate
Header header
string child_frame_id   # of the pose
int32 UNKNOWN=-1
string NAME = a # b
geometry_msgs/Pose[] poses
float64[36] covariance
Twist twist
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
================================================================================
MSG: geometry_msgs/Pose
Point position
===
MSG: geometry_msgs/Point
float64 x
===
MSG: nav_msgs/Twist
float32 speed 1.5
)";

TEST(MessageDefinition, of_ros1_gives_the_fields_of_every_type_in_order) {
  const MessageFields types = parse_definition("nav_msgs/Odometry", kOdometry);
  EXPECT_THAT(types, SizeIs(5));
  const auto& fields = types.at("nav_msgs/Odometry");
  ASSERT_THAT(fields, SizeIs(5));
  EXPECT_EQ(fields[0].type, "std_msgs/Header");
  EXPECT_EQ(fields[1].name, "child_frame_id");
  EXPECT_EQ(fields[2].type, "geometry_msgs/Pose");
  EXPECT_EQ(fields[2].kind, Kind::kSequence);
  EXPECT_EQ(fields[3].kind, Kind::kArray);
  EXPECT_EQ(fields[3].capacity, 36U);
  EXPECT_EQ(fields[4].type, "nav_msgs/Twist");
  EXPECT_EQ(types.at("geometry_msgs/Pose")[0].type, "geometry_msgs/Point");
  EXPECT_EQ(types.at("nav_msgs/Twist")[0].name, "speed");
}

TEST(MessageDefinition, of_ros2_has_bounds_defaults_and_names_with_msg) {
  const MessageFields types =
      parse_definition("my_msgs/msg/A",
                       "builtin_interfaces/Time stamp\nstring<=10 name \"x=1\"\nint32[<=5] few\nother_msgs/msg/B b\n"
                       "================\nMSG: other_msgs/B\nuint8 K=3\r\nbool on\r\n");
  const auto& fields = types.at("my_msgs/A");
  ASSERT_THAT(fields, SizeIs(4));
  EXPECT_EQ(fields[1].type, "string");
  EXPECT_EQ(fields[2].kind, Kind::kSequence);
  EXPECT_EQ(fields[3].type, "other_msgs/B");
  EXPECT_THAT(types.at("other_msgs/B"), SizeIs(1));
  EXPECT_THAT(types.at("builtin_interfaces/Time"), SizeIs(2));
}

TEST(MessageDefinition, without_fields_is_an_empty_message) {
  EXPECT_THAT(parse_definition("std_msgs/Empty", "# nothing\n").at("std_msgs/Empty"), SizeIs(0));
}

void refuses(const std::string& text, const std::string& cause) {
  EXPECT_THAT([&] { parse_definition("a/A", text); },
              ThrowsMessage<DefinitionError>(AllOf(HasSubstr("definition of a/A"), HasSubstr(cause))));
}

TEST(MessageDefinition, malformed_names_line_and_what_is_expected) {
  refuses("int32 a\nint32\n", "line 2: 'int32' has no name; expected: TYPE NAME");
  refuses("int32 9a\n", "line 1: '9a' is not the name");
  refuses("in-t a\n", "line 1: 'in-t' is not the name of a type");
  refuses("int32[x] a\n", "'[x]' is not the size of an array");
  refuses("int32[99999999999] a\n", "is not the size");
  refuses("int32] a\n", "has no '['");
  refuses("int32 a\n===\nint32 b\n", "line 3");
  refuses("int32 a\n===\n", "without 'MSG:");
  refuses("int32 a\n===\nMSG: B\n", "'B' is not PACKAGE/TYPE");
}

TEST(MessageDefinition, that_is_incomplete_or_endless_is_refused) {
  refuses("B b\n", "the text of a/B, used by a/A, is missing");
  refuses("A a\n", "nested in itself");
  refuses("B b\n===\nMSG: a/B\nA[] a\n", "nested in itself");
  EXPECT_THROW(parse_definition("A", "int32 a\n"), DefinitionError);
}

}  // namespace
}  // namespace rtd::ros
