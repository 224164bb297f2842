// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "common/bus/discovery.hpp"

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

}  // namespace
}  // namespace rtd::bus
