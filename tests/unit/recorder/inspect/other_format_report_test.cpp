// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/inspect/inspect_commands.hpp"

#include <gmock/gmock.h>
#include <sqlite3.h>

#include "common/mcap/recording_file.hpp"
#include "tests/unit/camera/image_bag.hpp"

namespace rtd::recordings {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

std::filesystem::path path_of(const std::string& uri) {
  return uri.substr(uri.find(':') + 1);
}

TEST(OtherFormatReport, counts_and_times_the_messages_of_a_bag) {
  camera::test::ImageBag bag;
  bag.add_info();
  for (const double second : {1.0, 2.0, 3.0}) {
    bag.add_color(second);
    bag.add_depth(second);
  }
  const std::string file = path_of(bag.uri());
  const auto report = report_on_other_format(file);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->format, "ROS 1 bag");
  EXPECT_EQ(report->messages, 7U);
  ASSERT_THAT(report->channels, SizeIs(3));
  for (const ChannelReport& channel : report->channels) {
    if (channel.channel.topic == camera::test::ImageBag::kInfo) continue;
    EXPECT_EQ(channel.timing.messages, 3U) << channel.channel.topic;
    EXPECT_NEAR(channel.timing.rate_hz, 1, 1e-6) << channel.channel.topic;
    EXPECT_EQ(channel.type, "sensor_msgs/Image");
  }
  EXPECT_FALSE(report->damaged());
  const std::string text = to_text(*report, "a.bag");
  EXPECT_THAT(text, HasSubstr("ROS 1 bag"));
  EXPECT_THAT(text, HasSubstr("7 on 3 topics"));
  EXPECT_EQ(text.find("checksums"), std::string::npos) << "it has none";
  EXPECT_EQ(to_json(*report, "a.bag")["format"], "ROS 1 bag");
}

TEST(OtherFormatReport, shows_topics_of_a_database_that_have_no_message) {
  const rtd::test::TemporaryFile file("a.db3", "");
  std::filesystem::remove(file.path());
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.path().c_str(), &database), SQLITE_OK);
  constexpr char kContent[] =
      "CREATE TABLE topics(id INTEGER PRIMARY KEY,name,type,serialization_format,offered_qos_profiles);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id,timestamp,data);"
      "INSERT INTO topics VALUES(1,'/imu','sensor_msgs/msg/Imu','cdr',''),(2,'/odom','nav_msgs/msg/Odometry','cdr','');"
      "INSERT INTO messages(topic_id,timestamp,data) VALUES(1,1000,x'00010000'),(1,2000,x'0001000007');";
  EXPECT_EQ(sqlite3_exec(database, kContent, nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  const auto report = report_on_other_format(file.path());
  ASSERT_TRUE(report);
  ASSERT_THAT(report->channels, SizeIs(2));
  EXPECT_EQ(report->messages, 2U);
  EXPECT_EQ(report->channels[0].payload_bytes, 9U);
  EXPECT_EQ(report->channels[1].channel.topic, "/odom");
  EXPECT_EQ(report->channels[1].timing.messages, 0U);
  EXPECT_EQ(report->end_ns - report->start_ns, 1000U);
}

TEST(OtherFormatReport, is_for_files_of_other_programs_only) {
  const rtd::test::TemporaryFile text("a.txt", "hello"), broken("a.bag", "#ROSBAG V2.0\nxxx");
  EXPECT_FALSE(report_on_other_format(text.path()));
  EXPECT_FALSE(report_on_other_format("/nonexistent"));
  EXPECT_THROW(report_on_other_format(broken.path()), mcap::RecordingFileError);
}

}  // namespace
}  // namespace rtd::recordings
