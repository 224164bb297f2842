// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "common/bus/bus.hpp"
#include "common/bus/discovery.hpp"
#include "common/bus/library_log.hpp"

namespace rtd::bus {
namespace {

TEST(EndpointRegistry, endpoints_with_names_that_no_program_may_have_are_left_out) {
  EndpointRegistry registry;
  registry.note(TopicWriter{{1}, {"rt/scan", "sensor_msgs::msg::dds_::LaserScan_"}});
  std::uint8_t id = 2;
  for (const char* name : {"", "rt/a\nlevel=error", "rt/\033[2J", "rt/a b", "rt/\"", "rt/\xc2\x9b"}) {
    registry.note(TopicWriter{{id++}, {name, "a::B_"}});
    registry.note(TopicWriter{{id++}, {"rt/a", name}});
    registry.note(TopicReader{{id++}, {name, "a::B_"}});
  }
  ASSERT_EQ(registry.writers().size(), 1U);
  EXPECT_EQ(registry.writers()[0].topic.name, "rt/scan");
  EXPECT_TRUE(registry.readers().empty());
}

TEST(EndpointRegistry, names_of_connections_are_printable) {
  EndpointRegistry registry;
  registry.note(ParticipantId{1}, "rtd-slam\033[31m\n");
  EXPECT_EQ(registry.participants().at(ParticipantId{1}), "rtd-slam\\x1b[31m\\x0a");
}

TEST(TopicTypes, a_type_whose_name_could_forge_a_line_is_no_mismatch) {
  std::string reported;
  StatusCallbacks callbacks;
  callbacks.on_type_mismatch = [&](const std::string& type) { reported = type; };
  {
    StatusReporter status(callbacks);
    TopicTypes types;
    const TopicTypes::Watch watch(types, "rt/scan", "a::B_", status);
    types.appeared("1", "rt/scan", "a::B_\nlevel=error event=forged");
    types.appeared("2", "rt/scan", "a::B_ event=forged");
  }
  EXPECT_EQ(reported, "");
}

TEST(TopicCounters, sum_up_what_the_endpoints_of_a_topic_report) {
  TopicCounters counters;
  const StatusCallbacks one = counters.count("rtd/frame", {}), two = counters.count("rtd/frame", {});
  one.on_samples_lost(3);
  one.on_samples_lost(5);  // the total of this endpoint
  two.on_samples_lost(1);
  two.on_samples_rejected(2);
  one.on_incompatible_qos("DURABILITY");
  one.on_type_mismatch("foo::Bar_");
  EXPECT_EQ(counters.troubles().at("rtd/frame"), (TopicTrouble{6, 2, 1, 1, "DURABILITY", "foo::Bar_"}));
}

TEST(TopicCounters, know_nothing_of_topics_without_trouble) {
  TopicCounters counters;
  const StatusCallbacks callbacks = counters.count("rtd/frame", {});
  EXPECT_TRUE(counters.troubles().empty());
  EXPECT_FALSE(callbacks.on_matched);
}

TEST(TopicCounters, pass_on_what_they_count) {
  int lost = 0;
  std::string policy;
  StatusCallbacks callbacks;
  callbacks.on_samples_lost = [&](int total) { lost = total; };
  callbacks.on_incompatible_qos = [&](const std::string& name) { policy = name; };
  TopicCounters counters;
  const StatusCallbacks counted = counters.count("rtd/frame", callbacks);
  counted.on_samples_lost(4);
  counted.on_incompatible_qos("DEADLINE");
  EXPECT_EQ(lost, 4);
  EXPECT_EQ(policy, "DEADLINE");
}

std::string printed(const auto& work) {
  testing::internal::CaptureStderr();
  work();
  return testing::internal::GetCapturedStderr();
}

TEST(LibraryLog, quotes_what_a_peer_made_of_itself_as_text) {
  LibraryLog log("DDS");
  EXPECT_EQ(printed([&] { log.print("topic \033[31mRED\nforged \n"); }), "DDS: topic \\x1b[31mRED\\x0aforged\n");
}

TEST(LibraryLog, is_short_however_much_a_peer_causes) {
  LibraryLog log("DDS");
  const std::string text = printed([&] {
    for (int i = 0; i < 100; ++i) log.print(std::string(10'000, 'x'));
  });
  EXPECT_EQ(std::ranges::count(text, '\n'), 10);
  EXPECT_LT(text.size(), 2600U);
}

}  // namespace
}  // namespace rtd::bus
