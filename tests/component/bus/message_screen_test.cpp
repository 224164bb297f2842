// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// The edge of the bus: hostile, well-formed messages never reach a reader, whatever the vendor.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <thread>

#include "common/bus/bus_factory.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/peer_process.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"
#include "tests/unit/bus/message_walk.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;

class MessageScreen : public ::testing::TestWithParam<std::string> {
 protected:
  /// Sends each hostile message and then a good one: that alone arrives, the others are counted with the last's field.
  template <class T>
  void expect_refused(const Topic<T>& topic, const std::vector<std::function<void(T&)>>& attacks,
                      const std::string& field) {
    Collector<T> received;
    const auto reader = receiver_->reader(topic, received.callback());
    auto writer = sender_->writer(topic);
    wait_matched(reader, writer);
    for (const auto& attack : attacks) {
      const auto hostile = walk::plausible_message<T>();
      attack(*hostile);
      ASSERT_TRUE(writer.write(*hostile));
      writer.wait_acknowledged(1000);
      for (int i = 0; i < 50 && receiver_->troubles()[topic.name].implausible == refused_; ++i) {
        std::this_thread::sleep_for(10ms);  // a best-effort writer does not know when it has arrived
      }
      EXPECT_EQ(receiver_->troubles()[topic.name].implausible, ++refused_);
    }
    refused_ = 0;
    ASSERT_TRUE(writer.write(*walk::plausible_message<T>()));
    EXPECT_NE(received.next(), nullptr);
    EXPECT_EQ(received.size(), 0U);
    EXPECT_EQ(receiver_->troubles()[topic.name].implausible_field, field);
  }

  std::shared_ptr<Bus> sender_ = connect_to(GetParam()), receiver_ = connect_to(GetParam());
  std::uint64_t refused_ = 0;
};

constexpr std::int64_t kEarliest = std::numeric_limits<std::int64_t>::min(),
                       kLatest = std::numeric_limits<std::int64_t>::max();

TEST_P(MessageScreen, feature_frames_of_absurd_size_never_arrive) {
  expect_refused<msg::FeatureFrame>(
      topics::kFeatures,
      {[](auto& frame) { frame.width = frame.height = 2'000'000'000; }, [](auto& frame) { frame.width = 1; },
       [](auto& frame) { frame.count = 5000; }, [](auto& frame) { frame.features[0].octave = 255; }},
      "rtd_msgs/Feature.octave");
}

TEST_P(MessageScreen, clouds_whose_fields_lie_beyond_their_points_never_arrive) {
  expect_refused<msg::PointCloud2>(
      topics::kMapPoints,
      {[](auto& cloud) { cloud.fields[0].offset = 0xFFFFFFFC; }, [](auto& cloud) { cloud.point_step = 0; },
       [](auto& cloud) { cloud.width = 0xFFFFFFFF; }},
      "sensor_msgs/PointCloud2.row_step");
}

TEST_P(MessageScreen, sequence_numbers_and_stamps_that_would_overflow_never_arrive) {
  expect_refused<msg::TrackingResult>(
      topics::kTracking,
      {[](auto& result) { result.seq = std::numeric_limits<std::uint64_t>::max(); },
       [](auto& result) { result.published_ns = kLatest; }, [](auto& result) { result.finished_ns = kEarliest; }},
      "rtd_msgs/TrackingResult.finished_ns");
  expect_refused<msg::RgbdFrame>(
      topics::kFrame,
      {[](auto& frame) { frame.seq = std::numeric_limits<std::uint64_t>::max(); },
       [](auto& frame) { frame.stamp_ns = kEarliest; }, [](auto& frame) { frame.stamp_ns = kLatest; }},
      "rtd_msgs/RgbdFrame.stamp_ns");
  expect_refused<msg::KeyframeEvent>(topics::kKeyframes, {[](auto& event) { event.stamp_ns = kEarliest; }},
                                     "rtd_msgs/KeyframeEvent.stamp_ns");
}

TEST_P(MessageScreen, a_jump_of_the_sequence_numbers_of_a_writer_never_arrives) {
  Collector<msg::TrackingResult> received;
  const auto reader = receiver_->reader(topics::kTracking, received.callback());
  auto writer = sender_->writer(topics::kTracking);
  wait_matched(reader, writer);
  for (const std::uint64_t seq : {7ULL, 999'999'999'999ULL, 8ULL}) {
    const auto result = walk::plausible_message<msg::TrackingResult>();
    result->seq = seq;
    ASSERT_TRUE(writer.write(*result));
    writer.wait_acknowledged(1000);
  }
  EXPECT_EQ(received.next()->seq, 7U);
  EXPECT_EQ(received.next()->seq, 8U);
  EXPECT_EQ(receiver_->troubles()[topics::kTracking.name].implausible_field, "rtd_msgs/TrackingResult.seq (a jump)");
}

TEST_P(MessageScreen, heartbeats_that_would_forge_a_line_never_arrive) {
  expect_refused<msg::ServiceStatus>(
      topics::kStatus,
      {[](auto& status) { status.message = "\033[2J\033[31mroot password:"; },
       [](auto& status) { status.service = "slam\nslam"; }, [](auto& status) { status.metrics[0].name = "a\xc2\x9b"; }},
      "rtd_msgs/Metric.name");
}

INSTANTIATE_TEST_SUITE_P(Vendors, MessageScreen, ::testing::ValuesIn(inprocess::all_vendors()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace rtd::bus
