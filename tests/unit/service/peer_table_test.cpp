// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/peer_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace rtd::service {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

class PeerTableTest : public testing::Test {
 protected:
  static constexpr std::int64_t kS = 1'000'000'000;
  static bus::WriterId writer(int number) {
    bus::WriterId id{};
    id[0] = static_cast<std::uint8_t>(number);
    id[1] = static_cast<std::uint8_t>(number >> 8);
    return id;
  }
  bool beat(const std::string& service, int from) { return table_.note({.service = service}, writer(from), now_ns_); }
  /// As many new names, each of a writer of its own.
  int make_up(int names) {
    int taken = 0;
    for (int i = 0; i < names; ++i, ++made_up_) taken += beat("x" + std::to_string(made_up_), 1000 + made_up_) ? 1 : 0;
    return taken;
  }
  std::int64_t now_ns_ = 100 * kS;
  int made_up_ = 0;
  std::set<bus::ParticipantId> gone_;
  PeerTable table_{[this](const bus::ParticipantId& connection) { return gone_.contains(connection); }};
};

TEST_F(PeerTableTest, made_up_names_take_no_place_from_a_service) {
  EXPECT_EQ(make_up(300), 100);
  EXPECT_TRUE(beat("slam", 1));
  EXPECT_TRUE(beat("camera", 2));
  EXPECT_FALSE(beat("one_more", 3)) << "the others are alive";
}

TEST_F(PeerTableTest, made_up_names_do_not_stay) {
  make_up(100);
  now_ns_ += 9 * kS;
  EXPECT_FALSE(beat("planner", 1));
  now_ns_ += 2 * kS;
  EXPECT_TRUE(beat("planner", 1)) << "a silent one makes room";
  EXPECT_THAT(table_.forget_silent(now_ns_), SizeIs(1));
  EXPECT_TRUE(beat("slam", 2));
  now_ns_ += 61 * kS;
  EXPECT_THAT(table_.forget_silent(now_ns_), SizeIs(100));
  EXPECT_THAT(table_.peers(), SizeIs(1)) << "slam is known for ever: it may be reported as dead";
}

TEST_F(PeerTableTest, one_writer_has_one_name) {
  EXPECT_TRUE(beat("mapper", 7));
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(beat("y" + std::to_string(i), 7));
  EXPECT_TRUE(beat("mapper", 7));
  EXPECT_THAT(table_.peers(), SizeIs(1));
  EXPECT_EQ(table_.refused(), 1000U);
}

TEST_F(PeerTableTest, a_name_belongs_to_the_one_that_lives) {
  EXPECT_TRUE(beat("slam", 1));
  now_ns_ += kS;
  EXPECT_FALSE(beat("slam", 2));
  EXPECT_TRUE(beat("slam", 1));
}

TEST_F(PeerTableTest, the_successor_of_one_that_died_has_its_name_at_once) {
  EXPECT_TRUE(beat("slam", 1));
  now_ns_ += kS / 2;
  gone_.insert(bus::participant_of(writer(1)));
  EXPECT_TRUE(beat("slam", 2));
  EXPECT_FALSE(beat("mapper", 2)) << "it has a name now";
}

TEST_F(PeerTableTest, one_that_was_silent_for_a_while_has_its_name_back) {
  EXPECT_TRUE(beat("slam", 1));
  now_ns_ += 2 * kS;
  EXPECT_TRUE(beat("slam", 2));
  EXPECT_TRUE(beat("slam", 1));
  EXPECT_FALSE(beat("slam", 2));
}

TEST_F(PeerTableTest, no_peer_was_silent_while_this_process_stood_still) {
  EXPECT_TRUE(beat("slam", 1));
  now_ns_ += 10 * kS;
  EXPECT_TRUE(beat("filter", 2));
  table_.exclude_pause(10 * kS, now_ns_);
  EXPECT_EQ(table_.peers().at("slam").received_ns, now_ns_);
  EXPECT_EQ(table_.peers().at("filter").received_ns, now_ns_) << "not in the future";
}

}  // namespace
}  // namespace rtd::service
