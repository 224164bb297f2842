// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "common/bus/bus_factory.hpp"
#include "common/concurrency/bounded_queue.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/patterns.hpp"
#include "tests/component/bus/peer_process.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;

std::shared_ptr<Bus> connect_inprocess(std::uint32_t domain = 7) {
  BusOptions options;
  options.vendor = inprocess::vendor();
  options.domain = domain;
  return connect(options);
}

TEST(InprocessBus, delivers_in_order_between_two_connections_of_one_domain) {
  const auto sender = connect_inprocess(), receiver = connect_inprocess();
  Collector<msg::TrackingResult> results;
  const auto reader = receiver->reader(topics::kTracking, results.callback());
  auto writer = sender->writer(topics::kTracking);

  for (std::uint64_t seq = 0; seq < 20; ++seq) writer.write(msg::TrackingResult{.seq = seq});

  for (std::uint64_t seq = 0; seq < 20; ++seq) EXPECT_EQ(results.next()->seq, seq);
}

TEST(InprocessBus, keeps_domains_and_topics_apart) {
  const auto here = connect_inprocess(1), there = connect_inprocess(2);
  Collector<msg::PoseStamped> other_domain, other_topic, same;
  const auto reader_there = there->reader(topics::kPose, other_domain.callback());
  const Topic<msg::PoseStamped> elsewhere{"rt/elsewhere", QosProfile::kPose};
  const auto reader_elsewhere = here->reader(elsewhere, other_topic.callback());
  const auto reader_same = here->reader(topics::kPose, same.callback());
  auto writer = here->writer(topics::kPose);

  writer.write(msg::PoseStamped{});

  EXPECT_NE(same.next(), nullptr);
  EXPECT_EQ(writer.matched(), 1);
  EXPECT_EQ(other_domain.size(), 0U);
  EXPECT_EQ(other_topic.size(), 0U);
}

TEST(InprocessBus, passes_a_loaned_frame_on_without_copying) {
  const auto bus = connect_inprocess();
  Collector<msg::RgbdFrame> frames;
  const auto reader = bus->reader(topics::kFrame, frames.callback());
  auto writer = bus->writer(topics::kFrame);

  auto loan = writer.loan();
  const msg::RgbdFrame* slot = &*loan;
  fill_frame(*loan, 12);
  EXPECT_TRUE(writer.write(std::move(loan)));

  const auto frame = frames.next();
  EXPECT_EQ(frame.get(), slot);
  EXPECT_EQ(frame->seq, 12U);
}

TEST(InprocessBus, replays_the_last_of_a_transient_local_topic_to_a_late_reader) {
  const auto bus = connect_inprocess();
  auto keyframes = bus->writer(topics::kKeyframes);
  auto info = bus->writer(topics::kCameraInfo);
  for (std::uint64_t i = 0; i < 70; ++i)
    keyframes.write(msg::KeyframeEvent{.event_index = i, .kind = msg::KeyframeEventKind::kRemoved});
  info.write(msg::CameraInfo{.height = 240});
  info.write(msg::CameraInfo{.height = 480});

  Collector<msg::KeyframeEvent> late_keyframes;
  Collector<msg::CameraInfo> late_info;
  const auto keyframe_reader = bus->reader(topics::kKeyframes, late_keyframes.callback());
  const auto info_reader = bus->reader(topics::kCameraInfo, late_info.callback());

  for (std::uint64_t i = 6; i < 70; ++i) EXPECT_EQ(late_keyframes.next()->event_index, i);
  EXPECT_EQ(late_info.next()->height, 480U);
  EXPECT_EQ(late_info.size(), 0U);
}

TEST(InprocessBus, a_slow_reader_loses_the_oldest_and_gets_a_report) {
  const auto bus = connect_inprocess();
  concurrency::BoundedQueue<int> gate(1, concurrency::Overflow::kBlock), entered(1, concurrency::Overflow::kBlock);
  Collector<msg::RgbdFrame> frames;
  Collector<int> lost;
  StatusCallbacks callbacks;
  callbacks.on_samples_lost = [&](int total) { lost.push(std::make_shared<int>(total)); };
  const auto reader = bus->reader(
      topics::kFrame,
      [&](std::shared_ptr<const msg::RgbdFrame> frame) {
        entered.push(0);
        gate.pop();
        frames.push(std::move(frame));
      },
      callbacks);
  auto writer = bus->writer(topics::kFrame);
  const auto write = [&](std::uint64_t seq) {
    auto loan = writer.loan();
    fill_frame(*loan, seq);
    writer.write(std::move(loan));
  };

  write(0);
  entered.pop();  // the callback holds frame 0, the queue of four is empty
  for (std::uint64_t seq = 1; seq <= 6; ++seq) write(seq);
  gate.close();
  entered.close();

  for (const std::uint64_t seq : {0U, 3U, 4U, 5U, 6U}) EXPECT_EQ(frames.next()->seq, seq);
  EXPECT_EQ(*lost.next(), 1);
  EXPECT_EQ(*lost.next(), 2);
}

/// Two connections within one process, with every vendor.
class AnyBus : public ::testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<Bus> here = connect_to(GetParam()), there = connect_to(GetParam());
};

TEST_P(AnyBus, delivers_every_kind_of_message) {
  Collector<msg::FeatureFrame> features;
  Collector<msg::Odometry> odometry;
  Collector<msg::ServiceStatus> status;
  const auto features_reader = there->reader(topics::kFeatures, features.callback());
  const auto odometry_reader = there->reader(topics::kOdometry, odometry.callback());
  const auto status_reader = there->reader(topics::kStatus, status.callback());
  auto features_writer = here->writer(topics::kFeatures);
  auto odometry_writer = here->writer(topics::kOdometry);
  auto status_writer = here->writer(topics::kStatus);
  wait_matched(features_writer, odometry_writer, status_writer);

  auto sent = features_writer.loan();
  fill_features(*sent, 5);
  EXPECT_TRUE(features_writer.write(std::move(sent)));
  msg::Odometry pose;
  pose.child_frame_id = "camera";
  EXPECT_TRUE(odometry_writer.write(pose));
  msg::ServiceStatus heartbeat;
  heartbeat.service = "camera";
  heartbeat.metrics = {{"frames_in", 3.0}};
  EXPECT_TRUE(status_writer.write(heartbeat));

  EXPECT_TRUE(equals_pattern(*features.next()));
  EXPECT_EQ(odometry.next()->child_frame_id, "camera");
  EXPECT_EQ(status.next()->metrics.at(0).value, 3.0);
}

TEST_P(AnyBus, takes_an_unwritten_loan_back) {
  auto writer = here->writer(topics::kFrame);
  for (int i = 0; i < 20; ++i) const auto loan = writer.loan();
}

TEST_P(AnyBus, reports_matches_and_their_end_to_both_sides) {
  Collector<int> writer_peers, reader_peers;
  StatusCallbacks of_writer, of_reader;
  of_writer.on_matched = [&](int peers) { writer_peers.push(std::make_shared<int>(peers)); };
  of_reader.on_matched = [&](int peers) { reader_peers.push(std::make_shared<int>(peers)); };
  auto writer = std::make_unique<Writer<msg::Odometry>>(here->writer(topics::kOdometry, of_writer));
  const auto reader = there->reader<msg::Odometry>(
      topics::kOdometry, [](auto) {}, of_reader);
  EXPECT_EQ(*writer_peers.next(), 1);
  EXPECT_EQ(*reader_peers.next(), 1);
  EXPECT_EQ(reader.matched(), 1);

  writer.reset();
  EXPECT_EQ(*reader_peers.next(), 0);
}

TEST_P(AnyBus, names_the_policy_that_keeps_a_pair_apart) {
  Collector<std::string> by_writer, by_reader;
  StatusCallbacks of_writer, of_reader;
  of_writer.on_incompatible_qos = [&](const auto& policy) { by_writer.push(std::make_shared<std::string>(policy)); };
  of_reader.on_incompatible_qos = [&](const auto& policy) { by_reader.push(std::make_shared<std::string>(policy)); };
  const Topic<msg::CameraInfo> volatile_info{topics::kCameraInfo.name, QosProfile::kPose};
  auto writer = here->writer(volatile_info, of_writer);
  const auto reader = there->reader<msg::CameraInfo>(
      topics::kCameraInfo, [](auto) {}, of_reader);

  EXPECT_EQ(*by_reader.next(), "DURABILITY");
  EXPECT_EQ(*by_writer.next(), "DURABILITY");
  EXPECT_EQ(writer.matched(), 0);
}

TEST_P(AnyBus, no_callback_runs_after_the_reader_is_gone) {
  auto writer = here->writer(topics::kTracking);
  std::atomic<bool> stop{false};
  std::thread sender([&] {
    while (!stop) {
      writer.write(msg::TrackingResult{});
      std::this_thread::sleep_for(100us);
    }
  });
  for (int round = 0; round < 10; ++round) {
    auto received = std::make_unique<std::atomic<int>>(0);  // a late callback would be a use after free
    auto reader = there->reader(topics::kTracking, [&counter = *received](auto) { ++counter; });
    for (int i = 0; i < 5000 && *received < 3; ++i) std::this_thread::sleep_for(1ms);
    EXPECT_GE(*received, 3);
    reader = {};
    received.reset();
  }
  stop = true;
  sender.join();
}

INSTANTIATE_TEST_SUITE_P(Vendors, AnyBus, ::testing::ValuesIn(inprocess::all_vendors()), test_name);

TEST(BusFactory, an_unknown_vendor_names_the_known_ones) {
  BusOptions options;
  options.vendor = "fastdss";
  try {
    connect(options);
    FAIL() << "an unknown vendor was accepted";
  } catch (const BusError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("fastdss"), testing::HasSubstr(default_vendor())));
  }
}

TEST(BusFactory, rejects_a_domain_above_232) {
  BusOptions options;
  options.vendor = inprocess::vendor();
  options.domain = 233;
  EXPECT_THROW(connect(options), BusError);
}

}  // namespace
}  // namespace rtd::bus
