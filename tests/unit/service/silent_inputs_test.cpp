// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/silent_inputs.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "common/service/metric_names.hpp"
#include "common/service/peer_clocks.hpp"

namespace rtd::service {
namespace {

constexpr std::int64_t kMillisecondNs = 1'000'000;

/// Looks ten times a second, as the watch is called.
TEST(InputWatch, one_that_receives_nothing_more_is_silent_until_it_receives_again) {
  InputWatch watch;
  std::uint64_t sent = 0, received = 0;
  const auto look = [&](int times, bool arrives) {
    bool silent = false;
    for (int i = 0; i < times; ++i) {
      sent += 3;
      received += arrives ? 3 : 0;
      silent = watch.silent(received, sent);
    }
    return silent;
  };
  EXPECT_FALSE(look(10, true));
  EXPECT_FALSE(look(15, false));
  EXPECT_TRUE(look(3, false)) << "after 1.8 s";
  EXPECT_FALSE(look(1, true));
  EXPECT_FALSE(look(15, false));
}

TEST(InputWatch, a_camera_of_two_frames_a_second_that_is_cut_off_is_noticed_within_two_seconds) {
  InputWatch watch;
  watch.silent(7, 7);
  int silent_at = 0;
  for (int tenths = 1; silent_at == 0 && tenths < 50; ++tenths) {
    const auto sent = static_cast<std::uint64_t>(7 + (tenths - 1) / 5);  // heartbeats come later
    if (watch.silent(7, sent)) silent_at = tenths;
  }
  EXPECT_GT(silent_at, 15);
  EXPECT_LE(silent_at, 20);
}

TEST(InputWatch, silence_of_the_sender_does_not_count_nor_what_is_counted_late) {
  InputWatch watch;
  watch.silent(7, 7);
  for (int tenths = 1; tenths < 100; ++tenths) EXPECT_FALSE(watch.silent(7, tenths < 4 ? 7 : 55));
  EXPECT_FALSE(watch.silent(7, 3)) << "another one begins to count";
}

TEST(InputWatch, rare_messages_that_are_on_their_way_are_not_missed) {
  InputWatch watch;
  watch.silent(7, 7);
  for (int tenths = 1; tenths < 100; ++tenths) EXPECT_FALSE(watch.silent(tenths >= 60 ? 10 : 7, tenths >= 50 ? 10 : 7));
}

constexpr char kTopic[] = "rtd/features";

bus::WriterId writer(std::uint8_t connection) {
  return {connection};
}

bus::StatusCallbacks accepting(std::function<bool(const bus::WriterId&)> accepts) {
  bus::StatusCallbacks callbacks;
  callbacks.accepts = std::move(accepts);
  return callbacks;
}

/// A reader behind a gate that lets the first one pass, and the services that a heartbeat knows. Looks ten times a
/// second.
class SilentInputsTest : public testing::Test {
 protected:
  void heartbeat_of(const std::string& service, std::uint8_t connection, std::uint64_t sent, bool here = true) {
    msg::ServiceStatus status;
    status.service = service;
    status.stamp_ns = now_ns_;
    status.state = msg::ServiceState::kRunning;
    status.metrics = {{metric::kHostId, PeerClocks::this_host_id() + (here ? 0 : 1)},
                      {std::string(metric::kSentPrefix) + kTopic, static_cast<double>(sent)}};
    peers_.note(status, writer(connection), now_ns_);
  }
  void look(int times, const std::function<void()>& each) {
    for (int i = 0; i < times; ++i) {
      now_ns_ += 100 * kMillisecondNs;
      each();
      inputs_.look(traffic_.inputs(), {"slam", {99}, true, traffic_.sent()}, peers_, now_ns_);
    }
  }
  bool reported() const {
    msg::ServiceStatus status;
    inputs_.add_to(status);
    return !status.metrics.empty();
  }
  /// Filter sends three messages in each tenth of a second; they arrive, or not.
  void run_filter(int tenths, bool arrive, bool here = true) {
    look(tenths, [&] {
      heartbeat_of("filter", 1, sent_ += 3, here);
      for (int i = 0; arrive && i < 3; ++i) callbacks_.accepts(writer(1));
    });
  }

  std::int64_t now_ns_ = 1'000'000 * kMillisecondNs;
  std::uint64_t sent_ = 0;
  bus::Traffic traffic_;
  bus::WriterId passes_ = writer(1);
  bus::StatusCallbacks callbacks_ =
      traffic_.input(kTopic, true)->counting(accepting([this](const bus::WriterId& from) { return from == passes_; }));
  PeerTable peers_{[](const bus::ParticipantId&) { return false; }};
  SilentInputs inputs_{"rtd/status"};
};

TEST_F(SilentInputsTest, an_input_whose_source_sends_is_lost_when_nothing_arrives_and_is_named) {
  run_filter(20, true);
  EXPECT_TRUE(inputs_.lost().empty());
  run_filter(20, false);
  EXPECT_EQ(inputs_.lost(), "nothing arrives on rtd/features, although filter sends");
  msg::ServiceStatus status;
  inputs_.add_to(status);
  EXPECT_EQ(status.state, msg::ServiceState::kDegraded);
  EXPECT_EQ(status.message, inputs_.lost());
  ASSERT_EQ(status.metrics.size(), 1U);
  EXPECT_EQ(status.metrics.front().name, "topic.rtd/features.silent");
  run_filter(1, true);
  EXPECT_TRUE(inputs_.lost().empty());
  EXPECT_FALSE(reported());
}

TEST_F(SilentInputsTest, a_sender_that_is_stopped_or_waits_is_not_missed) {
  run_filter(20, true);
  look(50, [] {});  // no heartbeats either
  EXPECT_FALSE(reported());
  look(50, [&] { heartbeat_of("filter", 1, sent_); });
  EXPECT_FALSE(reported());
}

TEST_F(SilentInputsTest, messages_that_the_gate_refuses_arrive) {
  passes_ = writer(2);
  run_filter(50, true);
  EXPECT_FALSE(reported());
}

TEST_F(SilentInputsTest, a_source_that_is_not_followed_is_not_missed) {
  callbacks_.on_writer(writer(1), true);
  callbacks_.on_writer(writer(2), true);
  passes_ = writer(2);
  look(50, [&] {
    heartbeat_of("filter", 1, sent_ += 3);
    callbacks_.accepts(writer(2));
  });
  EXPECT_FALSE(reported());
}

TEST_F(SilentInputsTest, heartbeats_alone_end_no_service) {
  run_filter(50, false);
  EXPECT_FALSE(reported()) << "it has no writer here";
  callbacks_.on_writer(writer(1), true);
  run_filter(20, false);
  EXPECT_TRUE(reported());
  EXPECT_TRUE(inputs_.lost().empty()) << "no message of it was ever taken";
}

TEST_F(SilentInputsTest, a_sender_on_another_host_is_reported_alone) {
  run_filter(20, true, false);
  run_filter(20, false, false);
  EXPECT_TRUE(reported());
  EXPECT_TRUE(inputs_.lost().empty()) << "a restart does not mend a network";
}

TEST_F(SilentInputsTest, a_replay_speaks_for_its_other_connection) {
  look(20, [&] {
    heartbeat_of("replay", 7, sent_ += 3);
    callbacks_.accepts(writer(1));
  });
  look(20, [&] { heartbeat_of("replay", 7, sent_ += 3); });
  EXPECT_EQ(inputs_.lost(), "nothing arrives on rtd/features, although replay sends");
}

TEST_F(SilentInputsTest, one_that_was_stopped_has_time_to_take_what_waits) {
  run_filter(20, true);
  sent_ += 900;
  now_ns_ += 30'000 * kMillisecondNs;
  run_filter(15, false);
  EXPECT_FALSE(reported());
  run_filter(10, true);
  EXPECT_FALSE(reported());
}

TEST_F(SilentInputsTest, a_reader_that_handles_a_message_is_not_cut_off) {
  bus::ErasedCallback handle;
  const auto input = traffic_.input(kTopic, true);
  callbacks_ = input->counting(accepting([](const bus::WriterId&) { return true; }));
  handle = input->counting(bus::ErasedCallback([this](const auto&, const auto&) { run_filter(50, false); }));
  run_filter(20, true);
  handle(nullptr, writer(1));
  EXPECT_FALSE(reported());
}

TEST_F(SilentInputsTest, a_closed_reader_is_not_missed) {
  run_filter(20, true);
  callbacks_ = {};
  run_filter(30, false);
  EXPECT_FALSE(reported());
}

TEST_F(SilentInputsTest, a_reader_of_heartbeats_that_does_not_even_receive_its_own_is_lost) {
  const bus::StatusCallbacks status = traffic_.input("rtd/status", false)->counting(bus::StatusCallbacks());
  const bus::Traffic::Sent sent = traffic_.output("rtd/status");
  look(20, [&] {
    ++*sent;
    status.accepts(writer(99));
  });
  EXPECT_TRUE(inputs_.lost().empty());
  look(20, [&] { ++*sent; });
  EXPECT_EQ(inputs_.lost(), "nothing arrives on rtd/status, although slam sends");
}

TEST_F(SilentInputsTest, a_living_service_whose_heartbeats_reach_others_alone_is_reported) {
  const auto living = [this] { heartbeat_of("camera", 2, 0); };
  heartbeat_of("filter", 1, 0);
  peers_.peers().at("filter").health = PeerHealth::kHung;
  look(17, living);
  EXPECT_FALSE(reported());
  look(5, living);
  EXPECT_TRUE(reported());
  heartbeat_of("filter", 1, 0);
  peers_.peers().at("filter").health = PeerHealth::kAlive;
  look(1, living);
  EXPECT_FALSE(reported());
}

}  // namespace
}  // namespace rtd::service
