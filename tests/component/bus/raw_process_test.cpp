// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Raw readers on the topics of our own services, which send typed messages from another process.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <thread>

#include "common/bus/raw_bus.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/patterns.hpp"
#include "tests/component/bus/peer_process.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;
using Samples = Collector<RawSample>;

constexpr std::size_t kHeader = 4;

/// Whether a vendor keeps frames in the writer's shared memory.
bool shares_frames(const std::string& vendor) {
  return vendor == "fastdds";
}

class RawFrames : public ::testing::TestWithParam<std::tuple<std::string, bool>> {};

TEST_P(RawFrames, all_arrive_with_every_byte) {
  const auto& [vendor, in_place] = GetParam();
  constexpr std::uint64_t kFrames = 60;
  const auto typed = connect(options_of(vendor));
  const auto bus = connect_raw(options_of(vendor));
  auto go = typed->writer(topics::kTracking);
  const PeerProcess peer(vendor, "send_frames", test_domain(), kFrames);
  const TopicWriter camera = discovered_writer(*bus, topics::kFrame.name);
  EXPECT_EQ(camera.topic.type, "rtd_msgs::msg::dds_::RgbdFrame_");
  EXPECT_EQ(camera.shared_memory, shares_frames(vendor));
  Samples samples;
  RawReaderOptions options;
  options.in_place = in_place;
  const auto reader = bus->reader(camera.topic, options, into(samples));
  wait_matched(*reader, go);
  go.write(msg::TrackingResult{});

  auto frame = std::make_unique<msg::RgbdFrame>();
  for (std::uint64_t seq = 0; seq < kFrames; ++seq) {
    const auto sample = samples.next();
    ASSERT_EQ(sample->cdr().size(), kHeader + sizeof(*frame));
    std::memcpy(frame.get(), sample->cdr().data() + kHeader, sizeof(*frame));
    ASSERT_EQ(frame->seq, seq);
    ASSERT_TRUE(equals_pattern(*frame)) << "frame " << seq;
    ASSERT_EQ(sample->sequence, static_cast<std::int64_t>(seq) + 1);
    ASSERT_EQ(sample->writer, camera.id);
  }
}

INSTANTIATE_TEST_SUITE_P(Ways, RawFrames, ::testing::Combine(::testing::ValuesIn(dds_vendors()), ::testing::Bool()),
                         [](const auto& test) {
                           return std::get<0>(test.param) + (std::get<1>(test.param) ? "_in_place" : "_sent");
                         });

class RawProcesses : public ::testing::TestWithParam<std::string> {
 protected:
  const std::string vendor = GetParam();
};
INSTANTIATE_TEST_SUITE_P(Vendors, RawProcesses, ::testing::ValuesIn(dds_vendors()), test_name);

TEST_P(RawProcesses, history_of_our_latched_topics_reaches_a_late_reader) {
  const PeerProcess peer(vendor, "leave_history", test_domain(), 10);
  const auto bus = connect_raw(options_of(vendor));
  const TopicWriter slam = discovered_writer(*bus, topics::kKeyframes.name);
  EXPECT_EQ(slam.qos.durability, RawQos::Durability::kTransientLocal);
  EXPECT_TRUE(slam.qos.reliable);
  EXPECT_FALSE(slam.shared_memory);
  Samples samples;
  RawReaderOptions options;
  options.transient_local = true;
  const auto reader = bus->reader(slam.topic, options, into(samples));
  for (std::uint64_t i = 0; i < 10; ++i) {
    const auto sample = samples.next();
    msg::KeyframeEvent event{};
    ASSERT_EQ(sample->cdr().size(), kHeader + sizeof(event));
    std::memcpy(&event, sample->cdr().data() + kHeader, sizeof(event));
    EXPECT_EQ(event.event_index, i);
  }
}

TEST_P(RawProcesses, typed_readers_understand_raw_writers) {
  const auto typed = connect(options_of(vendor));
  const auto bus = connect_raw(options_of(vendor));
  Collector<msg::TrackingResult> results;
  const auto reader = typed->reader(topics::kTracking, results.callback());
  const auto writer = bus->writer({topics::kTracking.name, "rtd_msgs::msg::dds_::TrackingResult_"}, {});
  wait_matched(reader, *writer);
  msg::TrackingResult sent{};
  sent.seq = 42;
  std::vector<std::byte> bytes(kHeader + sizeof(sent), std::byte{0});
  bytes[1] = std::byte{1};
  std::memcpy(bytes.data() + kHeader, &sent, sizeof(sent));
  ASSERT_TRUE(writer->write(bytes));
  EXPECT_EQ(results.next()->seq, 42U);
}

TEST_P(RawProcesses, frames_from_a_raw_writer_reach_typed_readers) {
  const auto typed = connect(options_of(vendor));
  const auto bus = connect_raw(options_of(vendor));
  Collector<msg::RgbdFrame> frames;
  const auto reader = typed->reader(topics::kFrame, frames.callback());
  RawWriterOptions options;
  options.qos.depth = 4;
  options.fixed_bytes = static_cast<std::uint32_t>(kHeader + sizeof(msg::RgbdFrame));
  const auto writer = bus->writer({topics::kFrame.name, "rtd_msgs::msg::dds_::RgbdFrame_"}, options);
  wait_matched(reader, *writer);
  auto frame = std::make_unique<msg::RgbdFrame>();
  std::vector<std::byte> bytes(kHeader + sizeof(*frame), std::byte{0});
  bytes[1] = std::byte{1};
  for (std::uint64_t seq = 0; seq < 20; ++seq) {
    fill_frame(*frame, seq);
    std::memcpy(bytes.data() + kHeader, frame.get(), sizeof(*frame));
    ASSERT_TRUE(writer->write(bytes));
    const auto received = frames.next();
    ASSERT_EQ(received->seq, seq);
    ASSERT_TRUE(equals_pattern(*received));
  }
}

TEST_P(RawProcesses, one_topic_cannot_have_two_types) {
  const auto bus = connect_raw(options_of(vendor));
  const auto first = bus->reader({"rt/a", "x::A_"}, {}, {});
  EXPECT_THROW((void)bus->reader({"rt/a", "x::B_"}, {}, {}), BusError);
}

}  // namespace
}  // namespace rtd::bus
