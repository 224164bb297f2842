// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/source_gate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace rtd::bus {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Event = SourceGate::Event;

constexpr std::int64_t kMs = 1'000'000, kS = 1'000'000'000;

/// Of the connection of that number.
WriterId writer(std::uint8_t connection, std::uint8_t number = 1) {
  WriterId id{};
  id.front() = connection;
  id.back() = number;
  return id;
}

class SourceGateTest : public testing::Test {
 protected:
  const WriterId camera_ = writer(1), other_ = writer(2), third_ = writer(3);
  std::int64_t now_ns_ = 100 * kS;
  std::set<ParticipantId> gone_;
  std::vector<Event> events_;
  SourceGate gate_{{.clock = [this] { return now_ns_; },
                    .gone = [this](const ParticipantId& source) { return gone_.contains(source); },
                    .report = [this](Event event, const auto&, const auto&) { events_.push_back(event); }}};
};

TEST_F(SourceGateTest, the_first_source_passes_and_a_second_does_not) {
  EXPECT_TRUE(gate_.accepts(camera_));
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(gate_.accepts(other_));
    EXPECT_TRUE(gate_.accepts(camera_));
  }
  EXPECT_EQ(gate_.refused(), 3U);
  EXPECT_EQ(gate_.changes(), 0U);
  EXPECT_THAT(events_, ElementsAre(Event::kFirst, Event::kRefused, Event::kRefused, Event::kRefused));
}

TEST_F(SourceGateTest, a_source_that_stutters_keeps_its_place) {
  for (const std::int64_t pause_ns : {300 * kMs, 1 * kS, 5 * kS}) {
    EXPECT_TRUE(gate_.accepts(camera_));
    for (std::int64_t passed_ns = 0; passed_ns < pause_ns; passed_ns += kMs) {
      now_ns_ += kMs;
      EXPECT_FALSE(gate_.accepts(other_)) << passed_ns;
    }
    EXPECT_TRUE(gate_.accepts(camera_)) << pause_ns;
  }
}

TEST_F(SourceGateTest, after_a_long_silence_another_source_has_the_place_until_the_first_is_back) {
  EXPECT_TRUE(gate_.accepts(camera_));
  now_ns_ += SourceGate::kSilenceNs + kMs;
  EXPECT_TRUE(gate_.accepts(other_));
  EXPECT_TRUE(gate_.accepts(camera_));
  EXPECT_FALSE(gate_.accepts(other_));
  EXPECT_EQ(gate_.changes(), 2U);
  EXPECT_THAT(events_, ElementsAre(Event::kFirst, Event::kSilent, Event::kBack, Event::kRefused));
}

TEST_F(SourceGateTest, the_successor_of_a_source_that_ended_passes_at_once) {
  EXPECT_TRUE(gate_.accepts(camera_));
  gate_.note(camera_, false);
  EXPECT_TRUE(gate_.accepts(other_));
  EXPECT_THAT(events_, ElementsAre(Event::kFirst, Event::kTaken));
  EXPECT_EQ(gate_.source(), participant_of(other_));
}

TEST_F(SourceGateTest, the_successor_of_a_process_that_died_passes_at_once) {
  EXPECT_TRUE(gate_.accepts(camera_));
  now_ns_ += 100 * kMs;
  EXPECT_FALSE(gate_.accepts(other_));
  gone_.insert(participant_of(camera_));
  EXPECT_TRUE(gate_.accepts(other_));
}

TEST_F(SourceGateTest, late_messages_of_a_process_that_died_do_not_keep_its_successor_out) {
  EXPECT_TRUE(gate_.accepts(camera_));
  EXPECT_FALSE(gate_.accepts(other_)) << "the death is not known yet";
  now_ns_ += 400 * kMs;
  EXPECT_TRUE(gate_.accepts(camera_));
  gone_.insert(participant_of(camera_));
  now_ns_ += 5 * kS;
  EXPECT_TRUE(gate_.accepts(camera_)) << "held back until its connection is given up";
  EXPECT_TRUE(gate_.accepts(other_));
}

TEST_F(SourceGateTest, one_that_sent_beside_it_waits_for_the_long_silence_and_a_newcomer_does_not) {
  EXPECT_TRUE(gate_.accepts(camera_));
  for (int i = 0; i < 30; ++i) {
    now_ns_ += 50 * kMs;
    EXPECT_FALSE(gate_.accepts(other_));
    EXPECT_TRUE(gate_.accepts(camera_));
  }
  gate_.note(camera_, false);
  now_ns_ += 9 * kS;
  EXPECT_FALSE(gate_.accepts(other_));
  EXPECT_TRUE(gate_.accepts(third_));
  EXPECT_FALSE(gate_.accepts(other_));
  now_ns_ += SourceGate::kSilenceNs + kMs;
  EXPECT_TRUE(gate_.accepts(other_));
}

/// A status event overtakes the messages that were sent before it.
TEST_F(SourceGateTest, the_last_messages_of_a_writer_that_is_gone_claim_nothing) {
  gate_.note(camera_, true);
  gate_.note(camera_, false);
  EXPECT_TRUE(gate_.accepts(camera_));
  EXPECT_TRUE(gate_.accepts(other_));
  EXPECT_FALSE(gate_.accepts(camera_));
  EXPECT_TRUE(gate_.accepts(other_));
}

/// So it is when everything stood still: its lease runs out before its next message is read.
TEST_F(SourceGateTest, a_source_that_was_given_up_by_mistake_has_its_place_back) {
  EXPECT_TRUE(gate_.accepts(camera_));
  gate_.note(camera_, false);
  EXPECT_TRUE(gate_.accepts(other_));
  gate_.note(camera_, true);
  EXPECT_TRUE(gate_.accepts(camera_));
  EXPECT_FALSE(gate_.accepts(other_));
}

TEST_F(SourceGateTest, all_writers_of_a_connection_are_one_source) {
  EXPECT_TRUE(gate_.accepts(writer(1, 1)));
  EXPECT_TRUE(gate_.accepts(writer(1, 2)));
  gate_.note(writer(1, 1), false);
  EXPECT_TRUE(gate_.accepts(writer(1, 2)));
  EXPECT_FALSE(gate_.accepts(other_));
}

TEST_F(SourceGateTest, any_number_of_made_up_sources_takes_no_place_away) {
  EXPECT_TRUE(gate_.accepts(camera_));
  for (int round = 0; round < 3; ++round) {
    now_ns_ += SourceGate::kSilenceNs + kMs;
    for (std::uint8_t number = 2; number < 250; ++number) {
      gate_.note(writer(number), true);
      gate_.accepts(writer(number));
      gate_.note(writer(number), false);
    }
    EXPECT_TRUE(gate_.accepts(camera_));
    EXPECT_FALSE(gate_.accepts(third_));
  }
}

}  // namespace
}  // namespace rtd::bus
