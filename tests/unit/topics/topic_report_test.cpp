// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/topics/core/topic_report.hpp"

#include <gmock/gmock.h>

namespace rtd::topics {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

bus::TopicWriter writer(const std::string& topic, const std::string& type, bool reliable = true) {
  bus::TopicWriter writer;
  writer.topic = {topic, type};
  writer.qos.reliable = reliable;
  return writer;
}

TEST(TopicReport, lists_topics_by_name_with_what_their_writers_offer) {
  auto info = writer("rt/camera/info", "sensor_msgs::msg::dds_::CameraInfo_");
  info.qos.durability = bus::RawQos::Durability::kTransientLocal;
  info.user_data = "typehash=RIHS01_12;";
  const auto rows = rows_of({writer("rtd/status", "rtd_msgs::msg::dds_::ServiceStatus_"), info,
                             writer("rtd/status", "rtd_msgs::msg::dds_::ServiceStatus_"),
                             writer("rt/chatter", "std_msgs::msg::dds_::String_", false)});
  EXPECT_EQ(list_text(rows),
            "topic         type                        writers  offers\n"
            "/camera/info  sensor_msgs/msg/CameraInfo        1  reliable, latched\n"
            "/chatter      std_msgs/msg/String               1  best effort  *\n"
            "rtd/status    rtd_msgs/msg/ServiceStatus        2  reliable\n"
            "* a type that `rtd topics echo` cannot read\n");
  const auto json = list_json(rows);
  EXPECT_EQ(json[0]["dds_topic"], "rt/camera/info");
  EXPECT_EQ(json[0]["writers"][0]["type_hash"], "RIHS01_12");
  EXPECT_TRUE(json[1]["writers"][0]["type_hash"].is_null());
  EXPECT_EQ(json[1]["readable"], false);
  EXPECT_EQ(json[2]["writers"].size(), 2U);
}

TEST(TopicReport, shows_rates_and_a_dash_where_there_is_none) {
  auto rows = rows_of({writer("rt/a", "x::msg::dds_::X_"), writer("rt/b", "x::msg::dds_::X_")});
  rows[0].rate = {31, 3100, 2, 30, 33.3, 1.25, 30, 40};
  const std::string text = rate_text(rows, 1.0);
  EXPECT_THAT(text, HasSubstr("/a        30.00     1.25    30.00    40.00        31     2     100 B   3.00 kB"));
  EXPECT_THAT(text, HasSubstr("/b            -"));
  EXPECT_THAT(text, HasSubstr("over 1.0 s"));
  const auto json = rate_json(rows, 1.0);
  EXPECT_EQ(json["topics"][0]["rate_hz"], 30.0);
  EXPECT_EQ(json["topics"][1]["messages"], 0);
}

}  // namespace
}  // namespace rtd::topics
