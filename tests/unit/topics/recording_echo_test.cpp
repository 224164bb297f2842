// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/topics/recording_echo.hpp"

#include <gmock/gmock.h>
#include <sqlite3.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "common/mcap/writer.hpp"
#include "common/ros2/type_description.hpp"
#include "common/ros_codec/wire.hpp"
#include "tests/support/rosbag1/bag_writer.hpp"

namespace rtd::topics {
namespace {

using rtd::test::BagWriter;
using rtd::test::TemporaryFile;
using namespace ::testing;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr char kReading[] =
    "Header header\nuint8 ON=1\nstring<=8 name\ntime when\nmy_msgs/Value[] values\n"
    "================\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
    "================\nMSG: my_msgs/Value\nfloat32 x\nbool ok\n";

using Content = std::vector<std::uint8_t>;

Content bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}
std::string number(std::uint64_t value, int bytes = 4) {
  return rtd::test::little_endian(value, bytes);
}
std::string real(float value) {
  return {reinterpret_cast<const char*>(&value), sizeof(value)};
}

/// As ROS 1 serialises my_msgs/Reading.
Content reading(const std::string& name) {
  return bytes_of(number(7) + number(12) + number(34) + number(3) + "map" + number(name.size()) + name + number(5) +
                  number(6) + number(2) + real(1.5F) + '\1' + real(2.5F) + '\0');
}

struct Result {
  int code = 0;
  std::string out, err;
};

Result echo(TopicsRequest request) {
  request.action = "echo";
  std::ostringstream out, err;
  const int code = run_topics(request, out, err);
  return {code, out.str(), err.str()};
}

Result echo(const TemporaryFile& file, const std::vector<std::string>& topics = {}) {
  TopicsRequest request;
  request.topics = {file.path().string()};
  request.verbose = true;
  request.topics.insert(request.topics.end(), topics.begin(), topics.end());
  return echo(request);
}

std::string readings_bag() {
  BagWriter bag;
  const auto a = bag.connection("/a", "my_msgs/Reading", kReading),
             b = bag.connection("/b", "std_msgs/X", "int8 data\n");
  bag.message(a, 1 * kSecond, reading("one"));
  bag.message(b, 2 * kSecond, bytes_of("\xff"));
  bag.message(a, 3 * kSecond, reading("two"));
  return bag.closed();
}

TEST(RecordingEcho, prints_a_topic_of_a_ros1_bag_by_its_definition) {
  const TemporaryFile file("x.bag", readings_bag());
  const Result result = echo(file, {"/a"});
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.out, StartsWith("header:\n  seq: 7\n  stamp:\n    sec: 12\n    nanosec: 34\n  frame_id: \"map\"\n"
                                     "name: \"one\"\nwhen:\n  sec: 5\n  nanosec: 6\n"
                                     "values:\n- x: 1.5\n  ok: true\n- x: 2.5\n  ok: false\n---\n"));
  EXPECT_THAT(result.out, AllOf(HasSubstr("\"two\""), Not(HasSubstr("data"))));
  EXPECT_THAT(result.err, IsEmpty());
}

TEST(RecordingEcho, without_topic_prints_all_in_the_order_of_recording_with_their_names) {
  const TemporaryFile file("x.bag", readings_bag());
  const Result result = echo(file);
  const std::size_t one = result.out.find("# /a my_msgs/Reading at 1.000000000 s\n"),
                    other = result.out.find("# /b std_msgs/X at 2.000000000 s\ndata: -1\n---\n"),
                    two = result.out.find("# /a my_msgs/Reading at 3.000000000 s\n");
  EXPECT_LT(one, other);
  EXPECT_LT(other, two);
  EXPECT_NE(two, std::string::npos);
}

TEST(RecordingEcho, ends_after_the_count_or_the_duration_and_prints_json) {
  const TemporaryFile file("x.bag", readings_bag());
  TopicsRequest request;
  request.topics = {file.path().string()};
  request.json = true;
  request.count = 1;
  const auto line = nlohmann::json::parse(echo(request).out);
  EXPECT_EQ(line["topic"], "/a");
  EXPECT_EQ(line["type"], "my_msgs/Reading");
  EXPECT_EQ(line["recorded_ns"], kSecond);
  EXPECT_EQ(line["message"]["values"][1]["x"], 2.5);
  request.count = 0;
  request.duration_s = 1.5;
  const std::string two = echo(request).out;
  EXPECT_EQ(std::count(two.begin(), two.end(), '\n'), 2);
}

/// An MCAP file with one message on each topic.
class Mcap {
 public:
  void add(const std::string& topic, const mcap::Schema& schema, const Content& bytes) {
    const auto channel = writer_.add(mcap::Channel{0, writer_.add(schema), topic, "cdr", {}});
    writer_.write(mcap::Message{channel, 0, 5, 5, std::as_bytes(std::span(bytes))});
  }
  std::string bytes() {
    writer_.close();
    return {reinterpret_cast<const char*>(sink_.bytes().data()), sink_.bytes().size()};
  }

 private:
  io::MemorySink sink_;
  mcap::Writer writer_{sink_, {}};
};

Content pose_cdr() {
  msg::PoseStamped pose;
  pose.header = {{12, 34}, "map"};
  pose.pose.position = {1, 2, 3};
  return ros::encode<ros::Wire::kCdr>(pose);
}

TEST(RecordingEcho, reads_ros2_messages_by_the_schema_of_an_mcap_file) {
  Mcap mcap;
  const std::string cdr = std::string("\0\1\0\0", 4) + number(4) + std::string("abc\0", 4) + '\1' +
                          std::string(7, '\0') + number(9, 8);  // the number is aligned to 8
  mcap.add("/x", {0, "my_msgs/msg/X", "ros2msg", "string name\nbool on true\nuint64 K=2\nuint64 n\n"}, bytes_of(cdr));
  const TemporaryFile file("x.mcap", mcap.bytes());
  EXPECT_EQ(echo(file, {"/x"}).out, "name: \"abc\"\non: true\nn: 9\n---\n");
}

TEST(RecordingEcho, names_types_without_schema_and_prints_those_that_are_known_here) {
  Mcap mcap;
  mcap.add("/pose", {0, "geometry_msgs/msg/PoseStamped", "", ""}, pose_cdr());
  mcap.add("/odd", {0, "my_msgs/msg/Odd", "ros2idl", "module my_msgs {};"}, pose_cdr());
  mcap.add("/none", {0, "my_msgs/msg/None", "", ""}, pose_cdr());
  mcap.add("/bad", {0, "my_msgs/msg/Bad", "ros2msg", "int32 a\nint32\n"}, pose_cdr());
  const TemporaryFile file("x.mcap", mcap.bytes());
  const Result all = echo(file);
  EXPECT_EQ(all.code, 0);
  EXPECT_THAT(all.out, AllOf(HasSubstr("# /pose geometry_msgs/PoseStamped"), HasSubstr("x: 1"), Not(HasSubstr("odd"))));
  EXPECT_THAT(all.err, AllOf(HasSubstr("/odd is left out: my_msgs/Odd is defined as ros2idl, which is not read"),
                             HasSubstr("/none is left out: the recording does not define my_msgs/None"),
                             HasSubstr("/bad is left out: definition of my_msgs/Bad, line 2: 'int32' has no name")));
  const Result named = echo(file, {"/odd"});
  EXPECT_EQ(named.code, 2);
  EXPECT_THAT(named.err, AllOf(HasSubstr("/odd cannot be printed"), HasSubstr("topics that can be printed: /pose\n")));
  const Result absent = echo(file, {"/absent"});
  EXPECT_EQ(absent.code, 2);
  EXPECT_THAT(absent.err, AllOf(HasSubstr("has no topic /absent"), HasSubstr("/pose")));
}

TEST(RecordingEcho, our_own_types_must_have_the_layout_of_the_recording) {
  const auto definition = ros2::definition_of("rtd_msgs::msg::dds_::ServiceStatus_");
  ASSERT_EQ(definition.encoding, "omgidl");
  std::string other = definition.text;
  other.replace(other.find("struct ServiceStatus_ {") + 23, 0, " octet extra;");
  Mcap mcap;
  mcap.add("rtd/status", {0, definition.name, "omgidl", definition.text}, bytes_of(std::string("\0\1\0\0", 4)));
  mcap.add("rtd/old", {0, definition.name, "omgidl", other}, bytes_of(std::string("\0\1\0\0", 4)));
  const TemporaryFile file("x.mcap", mcap.bytes());
  const Result result = echo(file);
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("rtd/old is left out: rtd_msgs/ServiceStatus was recorded by another version"),
                    Not(HasSubstr("rtd/status is left out"))));
  EXPECT_EQ(result.code, 3) << "the message of rtd/status is empty";
}

TEST(RecordingEcho, a_message_that_is_not_of_its_type_is_named_and_the_others_are_printed) {
  BagWriter bag;
  const auto a = bag.connection("/a", "my_msgs/Reading", kReading);
  bag.message(a, 1 * kSecond, bytes_of("short"));
  bag.message(a, 2 * kSecond, reading("two"));
  const TemporaryFile file("x.bag", bag.closed());
  const Result result = echo(file, {"/a"});
  EXPECT_EQ(result.code, 3);
  EXPECT_THAT(result.out, HasSubstr("\"two\""));
  EXPECT_THAT(result.err, HasSubstr("the message of /a recorded at 1000000000 ns is not a my_msgs/Reading: "));
}

TEST(RecordingEcho, a_type_that_claims_more_than_its_bytes_ends_at_once) {
  BagWriter bag;
  std::string text = "T0[4000000000] x\n";
  for (int i = 0; i < 40; ++i)
    text += "===\nMSG: a/T" + std::to_string(i) + '\n' + (i < 39 ? "T" + std::to_string(i + 1) + "[1000] x\n" : "");
  bag.message(bag.connection("/a", "a/A", text), kSecond, bytes_of("1234"));
  const TemporaryFile file("x.bag", bag.closed());
  const Result result = echo(file, {"/a"});
  EXPECT_EQ(result.code, 3);
  EXPECT_THAT(result.err, HasSubstr("more fields than the message has bytes"));
}

TEST(RecordingEcho, reads_a_db3_without_schemas_by_the_types_known_here) {
  const TemporaryFile file("x.db3", "");
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.path().c_str(), &database), SQLITE_OK);
  std::string hex;
  for (const std::uint8_t byte : pose_cdr()) {
    hex += "0123456789abcdef"[byte >> 4U];
    hex += "0123456789abcdef"[byte & 15U];
  }
  const std::string sql =
      "CREATE TABLE topics(id INTEGER PRIMARY KEY,name,type,serialization_format,offered_qos_profiles);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id,timestamp,data);"
      "INSERT INTO topics VALUES(1,'/pose','geometry_msgs/msg/PoseStamped','cdr','');"
      "INSERT INTO messages VALUES(1,1,5,x'" +
      hex + "');";
  ASSERT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  const Result result = echo(file, {"/pose"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("position:\n    x: 1\n    y: 2\n"));
}

TEST(RecordingEcho, reads_any_type_of_a_db3_that_defines_it) {
  const TemporaryFile file("x.db3", "");
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.path().c_str(), &database), SQLITE_OK);
  constexpr char kSql[] =
      "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY,ros_distro TEXT NOT NULL);"
      "INSERT INTO schema VALUES(4,'jazzy');"
      "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY,topic_type,encoding,encoded_message_definition,"
      "type_description_hash);"
      "INSERT INTO message_definitions VALUES(1,'my_msgs/msg/Odd','ros2msg','int8 odd','');"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY,name,type,serialization_format,offered_qos_profiles);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id,timestamp,data);"
      "INSERT INTO topics VALUES(1,'/odd','my_msgs/msg/Odd','cdr','');"
      "INSERT INTO messages VALUES(1,1,5,x'0001000007');";
  ASSERT_EQ(sqlite3_exec(database, kSql, nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  EXPECT_EQ(echo(file, {"/odd"}).out, "odd: 7\n---\n");
}

TEST(RecordingEcho, other_files_and_topics_without_messages_are_named) {
  const TemporaryFile text("x.mcap", "no recording");
  EXPECT_EQ(echo(text).code, 2);
  EXPECT_THAT(echo(text).err, HasSubstr("x.mcap"));
  TopicsRequest request;
  request.topics = {"/does/not/exist.bag"};
  EXPECT_EQ(echo(request).code, 2);
  EXPECT_THAT(echo(request).err, HasSubstr("exist.bag"));
  request.topics = {"/slam/pose", "/x"};
  EXPECT_EQ(echo(request).code, 2);
  EXPECT_THAT(echo(request).err, HasSubstr("no such file: /slam/pose"));
  BagWriter bag;
  const auto a = bag.connection("/a", "a/A", "int8 x\n");
  bag.message(a, kSecond, bytes_of("1"));
  bag.connection("/b", "a/A", "int8 x\n");
  const TemporaryFile file("x.bag", bag.closed());
  EXPECT_EQ(echo(file, {"/b"}).code, 1);
}

TEST(RecordingEcho, knows_files_from_topics) {
  EXPECT_TRUE(is_recording("walk.bag"));
  EXPECT_TRUE(is_recording("walk.mcap"));
  EXPECT_FALSE(is_recording("/slam/pose"));
  EXPECT_FALSE(is_recording("/proc"));
}

}  // namespace
}  // namespace rtd::topics
