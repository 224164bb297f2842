// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/offered_qos.hpp"

#include <gtest/gtest.h>

namespace rtd::bus {
namespace {

RawQos unusual() {
  RawQos qos;
  qos.reliable = false;
  qos.durability = RawQos::Durability::kTransientLocal;
  qos.depth = 7;
  qos.deadline_ns = 1'500'000'000;
  qos.lifespan_ns = 20'000'000;
  qos.liveliness = RawQos::Liveliness::kManualByTopic;
  qos.liveliness_lease_ns = 3'000'000'001;
  return qos;
}

TEST(OfferedQos, is_written_as_rosbag2_does) {
  EXPECT_EQ(offered_qos_text({RawQos{}}),
            "- history: 3\n  depth: 0\n  reliability: 1\n  durability: 2\n"
            "  deadline:\n    sec: 9223372036\n    nsec: 854775807\n"
            "  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n"
            "  liveliness: 1\n"
            "  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n"
            "  avoid_ros_namespace_conventions: false\n");
}

TEST(OfferedQos, reads_what_it_writes) {
  const std::vector<RawQos> offered{RawQos{}, unusual()};
  EXPECT_EQ(parse_offered_qos(offered_qos_text(offered)), offered);
  EXPECT_TRUE(parse_offered_qos(offered_qos_text({})).empty());
}

TEST(OfferedQos, reads_the_words_of_later_versions) {
  const auto offered = parse_offered_qos(
      "- history: keep_last\n  depth: 7\n  reliability: best_effort\n  durability: transient_local\n"
      "  deadline: {sec: 1, nsec: 500000000}\n  lifespan: {sec: 0, nsec: 20000000}\n"
      "  liveliness: manual_by_topic\n  liveliness_lease_duration: {sec: 3, nsec: 1}\n");
  ASSERT_EQ(offered.size(), 1U);
  EXPECT_EQ(offered[0], unusual());
}

TEST(OfferedQos, nonsense_is_the_default_or_nothing) {
  EXPECT_TRUE(parse_offered_qos("]{").empty());
  EXPECT_TRUE(parse_offered_qos("just words").empty());
  EXPECT_EQ(parse_offered_qos("- reliability: [1]\n  depth: many\n  deadline: {sec: -3, nsec: x}\n"),
            std::vector<RawQos>{RawQos{}});
}

}  // namespace
}  // namespace rtd::bus
