// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Between processes, with every vendor, and a peer that dies.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <thread>

#include "common/bus/bus_factory.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/patterns.hpp"
#include "tests/component/bus/peer_process.hpp"
#include "tests/support/sanitizers.hpp"
#include "tests/support/time_bounds.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;

class DdsProcesses : public ::testing::TestWithParam<std::string> {};

TEST_P(DdsProcesses, frames_arrive_whole_and_in_order) {
  constexpr std::uint64_t kFrames = 60;
  const auto bus = connect_to(GetParam());
  Collector<msg::RgbdFrame> frames;
  const auto reader = bus->reader(topics::kFrame, frames.callback());
  auto go = bus->writer(topics::kTracking);
  const PeerProcess peer(GetParam(), "send_frames", test_domain(), kFrames);
  wait_matched(reader, go);
  go.write(msg::TrackingResult{});

  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    const auto frame = frames.next();
    ASSERT_EQ(frame->seq, seq);
    ASSERT_TRUE(equals_pattern(*frame)) << "frame " << seq;
  }
}

/// How many frames the torn-frame test looks at: RTD_TORN_FRAMES=100000 is the full campaign, some minutes.
int torn_frames_wanted() {
  const char* text = std::getenv("RTD_TORN_FRAMES");
  return text != nullptr ? std::max(1, std::atoi(text)) : 200;
}

TEST_P(DdsProcesses, no_torn_frame_is_ever_delivered) {
  const int wanted = torn_frames_wanted();
  const auto bus = connect_to(GetParam());
  std::atomic<int> delivered{0}, torn{0};
  std::atomic<std::uint64_t> newest{0}, skipped{0};
  const auto reader = bus->reader(topics::kFrame, [&](std::shared_ptr<const msg::RgbdFrame> frame) {
    if (!equals_pattern(*frame)) ++torn;
    if (delivered > 0 && frame->seq > newest + 1) skipped += frame->seq - newest - 1;
    newest = frame->seq;
    ++delivered;
    std::this_thread::sleep_for((frame->seq % 4) * 1ms);  // slower than the writer, at all phases of its ring
  });
  const PeerProcess peer(GetParam(), "flood_frames", test_domain());

  const auto end = std::chrono::steady_clock::now() + 10s + wanted * 10ms;
  while (delivered < wanted && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(torn, 0);
  EXPECT_GE(delivered, test_support::kSanitized ? 0 : wanted / 10) << "a slow reader is overtaken";
  std::printf("%s: %d frames used, %d torn, %llu overwritten before they were taken\n", GetParam().c_str(),
              delivered.load(), torn.load(), static_cast<unsigned long long>(skipped.load()));
}

TEST_P(DdsProcesses, nothing_is_lost_with_three_feature_frames_in_flight) {
  constexpr std::uint64_t kMessages = 2000, kWindow = 3;
  const auto bus = connect_to(GetParam());
  Collector<msg::TrackingResult> results;
  const auto reader = bus->reader(topics::kTracking, results.callback());
  auto writer = bus->writer(topics::kFeatures);
  const PeerProcess peer(GetParam(), "answer_features", test_domain());
  wait_matched(writer, reader);

  auto features = std::make_unique<msg::FeatureFrame>();
  std::uint64_t sent = 0;
  for (std::uint64_t answered = 0; answered < kMessages; ++answered) {
    for (; sent < kMessages && sent < answered + kWindow; ++sent) {
      fill_features(*features, sent);
      ASSERT_TRUE(writer.write(*features));
    }
    const auto result = results.next();
    ASSERT_EQ(result->seq, answered);
    ASSERT_EQ(result->inliers, 1U) << "features " << answered << " arrived changed";
  }
}

/// This process and the other, which both continue at the same moment.
void stop_for_longer_than_the_lease(pid_t other) {
  kill(other, SIGSTOP);
  const std::string wake = "(sleep 7; kill -CONT " + std::to_string(getpid()) + ' ' + std::to_string(other) + ") &";
  ASSERT_EQ(std::system(wake.c_str()), 0);
  kill(getpid(), SIGSTOP);
}

/// The lease of both connections runs out meanwhile.
TEST_P(DdsProcesses, what_was_paused_longer_than_the_lease_talks_again) {
  const auto bus = connect_to(GetParam());
  Collector<msg::TrackingResult> results;
  const auto reader = bus->reader(topics::kTracking, results.callback());
  auto writer = bus->writer(topics::kFeatures);
  const PeerProcess peer(GetParam(), "answer_features", test_domain());
  wait_matched(writer, reader);
  auto features = std::make_unique<msg::FeatureFrame>();
  std::uint64_t seq = 0;
  const auto answered = [&](std::chrono::seconds patience) {
    const auto give_up = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < give_up) {
      fill_features(*features, ++seq);
      writer.write(*features);
      for (auto result = results.try_next(100ms); result; result = results.try_next(0ms)) {
        if (result->seq == seq) return true;
      }
    }
    return false;
  };
  ASSERT_TRUE(answered(5s));
  stop_for_longer_than_the_lease(peer.pid());
  EXPECT_TRUE(answered(10s));
}

/// The writer's shared memory has five slots: one that gets lost now and then ends the stream.
TEST_P(DdsProcesses, two_readers_get_every_frame_of_a_long_stream) {
  constexpr std::uint64_t kFrames = 2000, kWindow = 3;
  const auto bus = connect_to(GetParam());
  Collector<msg::TrackingResult> results;
  const auto reader = bus->reader(topics::kTracking, results.callback());
  auto writer = bus->writer(topics::kFrame);
  const PeerProcess filter(GetParam(), "answer_frames", test_domain(), 1),
      detector(GetParam(), "answer_frames", test_domain(), 2);
  while (writer.matched() < 2 || reader.matched() < 2) std::this_thread::sleep_for(1ms);

  std::map<std::uint32_t, std::uint64_t> answered;  // by the peer's number
  const auto answered_by_both = [&] {
    return answered.size() < 2 ? 0 : std::min(answered.begin()->second, answered.rbegin()->second);
  };
  std::uint64_t sent = 0;
  while (answered_by_both() < kFrames) {
    for (; sent < kFrames && sent < answered_by_both() + kWindow; ++sent) {
      auto frame = writer.loan();
      fill_frame(*frame, sent);
      ASSERT_TRUE(writer.write(std::move(frame))) << "frame " << sent;
    }
    const auto result = results.next();
    ASSERT_EQ(result->seq, answered[result->landmarks]++);
    ASSERT_EQ(result->inliers, 1U);
  }
}

TEST_P(DdsProcesses, late_reader_gets_keyframes_and_camera_info) {
  const PeerProcess peer(GetParam(), "leave_history", test_domain(), 40);
  std::this_thread::sleep_for(300ms);  // not needed to pass, but makes sure that the reader is late
  const auto bus = connect_to(GetParam());
  Collector<msg::KeyframeEvent> keyframes;
  Collector<msg::CameraInfo> info;
  const auto keyframe_reader = bus->reader(topics::kKeyframes, keyframes.callback());
  const auto info_reader = bus->reader(topics::kCameraInfo, info.callback());

  for (std::uint64_t i = 0; i < 40; ++i) EXPECT_EQ(keyframes.next()->event_index, i);
  const auto received = info.next();
  EXPECT_EQ(received->width, 640U);
  EXPECT_EQ(received->header.frame_id, "camera");
}

TEST_P(DdsProcesses, a_killed_writer_is_noticed_and_its_successor_received) {
  const auto bus = connect_to(GetParam());
  Collector<msg::ServiceStatus> status;
  Collector<int> alive;
  StatusCallbacks callbacks;
  callbacks.on_liveliness = [&](int writers) { alive.push(std::make_shared<int>(writers)); };
  const auto reader = bus->reader(topics::kStatus, status.callback(), callbacks);

  auto first = std::make_unique<PeerProcess>(GetParam(), "send_heartbeats", test_domain());
  EXPECT_EQ(*alive.next(), 1);
  const auto pid = status.next()->pid;
  first->kill_now();
  EXPECT_EQ(*alive.next(4s), 0);

  const PeerProcess second(GetParam(), "send_heartbeats", test_domain());
  while (status.next()->pid == pid) {
  }
}

/// Whether writes take longer than they may, 100 ms each, while this reader is stopped. It continues after 20 s.
bool holds_up(pid_t reader, Writer<msg::FeatureFrame>& writer) {
  constexpr int kMessages = 100;
  auto features = std::make_unique<msg::FeatureFrame>();
  fill_features(*features, 1);
  std::atomic<bool> written = false;
  kill(reader, SIGSTOP);
  std::thread waker([&] {
    for (int i = 0; i < 2000 && !written; ++i) std::this_thread::sleep_for(10ms);
    kill(reader, SIGCONT);
  });
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < kMessages; ++i) EXPECT_TRUE(writer.write(*features));
  const auto took = std::chrono::steady_clock::now() - start;
  written = true;
  waker.join();
  return took >= kMessages * (test_support::checks_time() ? 50ms : 150ms);
}

/// One that is stopped within a lock of Fast DDS in shared memory does, until it ends; `rtd run` ends it. That is rare:
/// another moment is tried.
TEST_P(DdsProcesses, a_frozen_reader_does_not_hold_up_the_writer) {
  constexpr int kTries = 3;
  const auto bus = connect_to(GetParam());
  auto writer = bus->writer(topics::kFeatures);
  PeerProcess peer(GetParam(), "answer_features", test_domain());
  wait_matched(writer);
  ASSERT_EQ(writer.matched(), 1);
  bool held_up = true;
  for (int i = 0; i < kTries && held_up; ++i) held_up = holds_up(peer.pid(), writer);
  EXPECT_FALSE(held_up);
}

INSTANTIATE_TEST_SUITE_P(Vendors, DdsProcesses, ::testing::ValuesIn(dds_vendors()), test_name);

}  // namespace
}  // namespace rtd::bus
