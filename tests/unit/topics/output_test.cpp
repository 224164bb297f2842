// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "services/topics/core/topic_report.hpp"

namespace rtd::topics {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(MessageText, is_yaml_for_people) {
  const auto message = nlohmann::ordered_json::parse(R"({
    "header": {"stamp": {"sec": 1, "nanosec": 5}, "frame_id": "map"},
    "k": [1.0, 0.25, "nan"], "none": [], "ok": true,
    "data": {"count": 921600, "first": [1, 2]},
    "boxes": [{"id": "a", "at": {"x": 1.5}}, {"id": "b", "at": {"x": 2}}],
    "poses": {"count": 9, "first": [{"x": 1}]}})");
  EXPECT_EQ(message_text(message),
            "header:\n"
            "  stamp:\n"
            "    sec: 1\n"
            "    nanosec: 5\n"
            "  frame_id: \"map\"\n"
            "k: [1, 0.25, .nan]\n"
            "none: []\n"
            "ok: true\n"
            "data: [1, 2, ... 921600 values]\n"
            "boxes:\n"
            "- id: \"a\"\n"
            "  at:\n"
            "    x: 1.5\n"
            "- id: \"b\"\n"
            "  at:\n"
            "    x: 2\n"
            "poses:  # the first of 9\n"
            "- x: 1\n"
            "---\n");
}

TEST(MessageText, for_people_has_dates_few_digits_and_short_arrays) {
  const auto message = nlohmann::ordered_json::parse(R"({
    "header": {"stamp": {"sec": 1764171062, "nanosec": 123000000}, "frame_id": "map"},
    "x": 1.23456789012, "tiny": 1e-12,
    "covariance": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    "data": {"count": 9, "first": [1, 1, 1, 1, 1, 1]},
    "few": [2, 2]})");
  EXPECT_EQ(message_text(message, Detail::kReadable),
            "header:\n"
            "  stamp: 2025-11-26 15:31:02.123 UTC\n"
            "  frame_id: \"map\"\n"
            "x: 1.234568\n"
            "tiny: 1e-12\n"
            "covariance: [6 x 0]\n"
            "data: [1, 1, 1, 1, 1, 1, ... 9 values]\n"
            "few: [2, 2]\n"
            "---\n");
  EXPECT_NE(message_text(message, Detail::kAll).find("nanosec: 123000000"), std::string::npos);
}

constexpr std::int64_t kMs = 1'000'000;

TEST(RateMeter, gives_rate_and_spread_of_the_periods) {
  RateMeter meter;
  for (const std::int64_t at_ms : {100, 130, 170, 200}) meter.add(at_ms * kMs, 50);
  const Rate rate = meter.rate();
  EXPECT_EQ(rate.messages, 4U);
  EXPECT_EQ(rate.bytes, 200U);
  EXPECT_NEAR(rate.hz, 30, 1e-9);
  EXPECT_NEAR(rate.mean_ms, 100.0 / 3, 1e-9);
  EXPECT_NEAR(rate.deviation_ms, 4.714045, 1e-5);  // of 30, 40, 30
  EXPECT_EQ(rate.shortest_ms, 30);
  EXPECT_EQ(rate.longest_ms, 40);
}

TEST(RateMeter, a_single_message_has_no_rate) {
  RateMeter meter;
  EXPECT_EQ(meter.rate().messages, 0U);
  meter.add(5, 10);
  meter.add_lost(3);
  EXPECT_EQ(meter.rate().hz, 0);
  EXPECT_EQ(meter.rate().messages, 1U);
  EXPECT_EQ(meter.rate().lost, 3U);
}

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
