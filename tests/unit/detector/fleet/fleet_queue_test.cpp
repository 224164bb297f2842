// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/fleet/fleet_queue.hpp"

#include <gmock/gmock.h>

#include <map>
#include <string>
#include <vector>

namespace rtd::detector {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Queue = FleetQueue<int>;

constexpr std::int64_t kMs = 1'000'000;

std::vector<std::string> robots_of(const Queue::Turn& turn) {
  std::vector<std::string> robots;
  for (const Queue::Taken& taken : turn.batch) robots.push_back(taken.robot);
  return robots;
}

TEST(FleetQueue, the_newest_image_wins_and_the_others_are_counted) {
  Queue queue({});
  for (int image = 1; image <= 4; ++image) queue.put("anna", image, image * kMs);
  const Queue::Turn turn = queue.take(5 * kMs);
  ASSERT_THAT(robots_of(turn), ElementsAre("anna"));
  EXPECT_EQ(turn.batch[0].image, 4);
  EXPECT_EQ(turn.batch[0].arrived_ns, 4 * kMs);
  EXPECT_EQ(queue.dropped("anna"), 3u);
  EXPECT_EQ(queue.dropped("ben"), 0u);
}

TEST(FleetQueue, without_images_it_waits_for_one) {
  Queue queue({});
  EXPECT_THAT(queue.take(0).batch, IsEmpty());
  EXPECT_FALSE(queue.take(0).wait_until_ns);
}

TEST(FleetQueue, a_single_robot_does_not_wait) {
  Queue queue({});
  queue.put("anna", 1, 10 * kMs);
  EXPECT_THAT(robots_of(queue.take(10 * kMs)), ElementsAre("anna"));
}

TEST(FleetQueue, waits_two_ms_for_others_while_fewer_than_half_are_there) {
  Queue queue({});
  for (const char* robot : {"a", "b", "c", "d"}) queue.put(robot, 0, 0);
  ASSERT_EQ(queue.take(0).batch.size(), 4u);
  queue.put("a", 1, 30 * kMs);
  const Queue::Turn early = queue.take(30 * kMs);
  EXPECT_THAT(early.batch, IsEmpty());
  EXPECT_EQ(early.wait_until_ns, 32 * kMs);
  queue.put("a", 2, 31 * kMs);  // a newer image does not prolong the wait
  EXPECT_EQ(queue.take(31 * kMs).wait_until_ns, 32 * kMs);
  EXPECT_THAT(robots_of(queue.take(32 * kMs)), ElementsAre("a"));
}

TEST(FleetQueue, half_of_the_active_robots_are_enough) {
  Queue queue({});
  for (const char* robot : {"a", "b", "c", "d"}) queue.put(robot, 0, 0);
  queue.take(0);
  queue.put("b", 1, 30 * kMs);
  queue.put("d", 1, 30 * kMs);
  EXPECT_THAT(robots_of(queue.take(30 * kMs)), ElementsAre("b", "d"));
}

TEST(FleetQueue, half_a_batch_is_enough_however_many_robots_there_are) {
  Queue queue({.batch = 2});
  for (const char* robot : {"a", "b", "c", "d", "e", "f"}) queue.put(robot, 0, 0);
  for (int i = 0; i < 3; ++i) queue.take(0);
  queue.put("e", 1, 30 * kMs);
  EXPECT_THAT(robots_of(queue.take(30 * kMs)), ElementsAre("e"));
}

TEST(FleetQueue, does_not_wait_for_robots_that_fell_silent) {
  Queue queue({});
  for (const char* robot : {"a", "b", "c", "d"}) queue.put(robot, 0, 0);
  queue.take(0);
  queue.put("a", 1, 600 * kMs);
  EXPECT_THAT(robots_of(queue.take(600 * kMs)), ElementsAre("a"));
}

TEST(FleetQueue, continues_where_the_last_batch_ended) {
  Queue queue({.batch = 2});
  const auto put_all = [&] {
    for (const char* robot : {"a", "b", "c"}) queue.put(robot, 0, 0);
  };
  put_all();
  EXPECT_THAT(robots_of(queue.take(0)), ElementsAre("a", "b"));
  put_all();
  EXPECT_THAT(robots_of(queue.take(0)), ElementsAre("c", "a"));
  put_all();
  EXPECT_THAT(robots_of(queue.take(0)), ElementsAre("b", "c"));
}

TEST(FleetQueue, the_turn_continues_when_the_robot_served_last_has_left) {
  Queue queue({.batch = 1});
  for (const char* robot : {"a", "b", "c"}) queue.put(robot, 0, 0);
  EXPECT_THAT(robots_of(queue.take(0)), ElementsAre("a"));
  EXPECT_THAT(robots_of(queue.take(0)), ElementsAre("b"));
  queue.remove("b");
  queue.put("a", 0, 0);
  EXPECT_THAT(robots_of(queue.take(0)), ElementsAre("c"));
  EXPECT_THAT(robots_of(queue.take(0)), ElementsAre("a"));
}

TEST(FleetQueue, a_robot_that_left_leaves_no_image) {
  Queue queue({});
  queue.put("anna", 1, 0);
  queue.remove("anna");
  EXPECT_THAT(queue.take(100 * kMs).batch, IsEmpty());
}

/// Robots in a simulated second: one floods, the network is too slow for all.
TEST(FleetQueue, a_flood_costs_the_others_nothing) {
  const auto served = [](int flood_hz) {
    Queue queue({.batch = 4});
    std::map<std::string, int> answers;
    constexpr int kRobots = 8, kRateHz = 30, kBatchMs = 40;  // 100 images a second for 240 of the eight
    for (int ms = 0; ms < 10'000; ++ms) {
      const std::int64_t now_ns = ms * kMs;
      const auto due = [ms](int hz) { return ms * hz / 1000 != (ms - 1) * hz / 1000; };
      for (int robot = 0; robot < kRobots; ++robot)
        if (due(kRateHz)) queue.put("robot" + std::to_string(robot), ms, now_ns);
      if (flood_hz > 0 && due(flood_hz)) queue.put("flood", ms, now_ns);
      if (ms % kBatchMs == 0)
        for (const Queue::Taken& taken : queue.take(now_ns).batch) ++answers[taken.robot];
    }
    return answers;
  };
  const std::map<std::string, int> beside_a_flood = served(500), beside_an_equal = served(30);
  for (const auto& [robot, count] : beside_an_equal) {
    EXPECT_NEAR(count, 1000 / 9, 3) << robot;
    EXPECT_GE(beside_a_flood.at(robot), 0.95 * count) << robot;
  }
  EXPECT_NEAR(beside_a_flood.at("flood"), 1000 / 9, 3);
}

}  // namespace
}  // namespace rtd::detector
