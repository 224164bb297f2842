// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Another program on our topics: samples of the right type name with the wrong bytes, from each vendor to
// each.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <tuple>
#include <vector>

#include "common/bus/qos.hpp"
#include "common/bus/raw_bus.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/patterns.hpp"
#include "tests/component/bus/peer_process.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

class MalformedSamples : public ::testing::TestWithParam<std::tuple<std::string, std::string>> {
 protected:
  static BusOptions options_with(const std::string& vendor) {
    BusOptions options;
    options.vendor = vendor;
    options.domain = test_domain();
    options.participant_name = "malformed-samples-test";
    return options;
  }

  /// Sends malformed samples, then expects a good one of ours to arrive all the same, and the others to be counted.
  template <class T>
  static void expect_survival(const Topic<T>& topic, const char* type_name, const std::vector<Bytes>& malformed,
                              const T& good) {
    const auto other = connect_raw(options_with(std::get<0>(GetParam())));
    const auto bus = connect(options_with(std::get<1>(GetParam())));
    Collector<T> received;
    std::atomic<int> lost{0};
    StatusCallbacks status;
    status.on_samples_lost = [&](int total) { lost = total; };
    const auto reader = bus->reader(topic, received.callback(), status);
    auto writer = bus->writer(topic);
    RawWriterOptions options;
    options.qos.depth = qos_settings(topic.profile).depth;
    const auto other_writer = other->writer({topic.name, type_name}, options);
    for (int i = 0; i < 5000 && (reader.matched() < 2 || other_writer->matched() < 1); ++i) {
      std::this_thread::sleep_for(1ms);
    }
    ASSERT_EQ(other_writer->matched(), 1);
    ASSERT_EQ(reader.matched(), 2);

    for (const Bytes& bytes : malformed) {
      ASSERT_TRUE(other_writer->write(std::as_bytes(std::span(bytes))));
      other_writer->wait_acknowledged(1000);
    }
    std::this_thread::sleep_for(100ms);  // let them arrive first
    ASSERT_TRUE(writer.write(good));

    EXPECT_NE(received.next(), nullptr);
    EXPECT_EQ(received.size(), 0U);
  }
};

TEST_P(MalformedSamples, malformed_plain_messages_are_left_out) {
  expect_survival<msg::TrackingResult>(topics::kTracking, "rtd_msgs::msg::dds_::TrackingResult_",
                                       {Bytes{0, 1, 0, 0}, Bytes(100, 0xff), Bytes{0, 1, 0, 0, 1, 2, 3, 4}}, {});
}

/// Most ROS 2 programs of a network send datagrams of up to 64 kB, we of 1400 B.
TEST_P(MalformedSamples, larger_datagrams_than_our_own_arrive) {
  if (GetParam() == std::make_tuple("cyclonedds", "cyclonedds")) GTEST_SKIP() << "has one limit for a process";
  BusOptions theirs = options_with(std::get<0>(GetParam())), ours = options_with(std::get<1>(GetParam()));
  theirs.shared_memory = ours.shared_memory = false;
  ours.network.max_datagram_bytes = 1400;
  const auto other = connect(theirs), bus = connect(ours);
  Collector<msg::CompressedImage> received;
  const auto reader = bus->reader(topics::kColorJpeg, received.callback());
  auto writer = other->writer(topics::kColorJpeg);
  for (int i = 0; i < 5000 && (reader.matched() < 1 || writer.matched() < 1); ++i) std::this_thread::sleep_for(1ms);
  msg::CompressedImage image;
  image.data.assign(30'000, 7);
  for (int i = 0; i < 50 && received.size() == 0; ++i) {  // a volatile reader of Cyclone begins at a heartbeat
    ASSERT_TRUE(writer.write(image));
    writer.wait_acknowledged(100);
  }
  EXPECT_EQ(received.next()->data, image.data);
}

TEST_P(MalformedSamples, frames_larger_than_their_arrays_are_left_out) {
  Bytes absurd(4 + sizeof(msg::RgbdFrame), 0xff);
  absurd[0] = 0;
  absurd[1] = 1;
  auto good = std::make_unique<msg::RgbdFrame>();
  fill_frame(*good, 1);
  expect_survival(topics::kFrame, "rtd_msgs::msg::dds_::RgbdFrame_", {Bytes{0, 1, 0, 0}, absurd}, *good);
}

TEST_P(MalformedSamples, malformed_variable_messages_are_left_out) {
  Bytes endless(200, 0xff);
  endless[0] = 0;
  endless[1] = 1;
  expect_survival<msg::Detection2DArray>(topics::kDetections, "vision_msgs::msg::dds_::Detection2DArray_",
                                         {Bytes{0, 1, 0, 0}, endless, Bytes{0, 1, 0, 0, 1, 2, 3, 4}}, {});
}

INSTANTIATE_TEST_SUITE_P(Pairs, MalformedSamples,
                         ::testing::Combine(::testing::ValuesIn(dds_vendors()), ::testing::ValuesIn(dds_vendors())),
                         [](const auto& test) { return std::get<0>(test.param) + "_to_" + std::get<1>(test.param); });

}  // namespace
}  // namespace rtd::bus
