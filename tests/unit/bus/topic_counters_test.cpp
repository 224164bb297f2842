// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/bus.hpp"

#include <gtest/gtest.h>

namespace rtd::bus {
namespace {

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

}  // namespace
}  // namespace rtd::bus
