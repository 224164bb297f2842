// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Another process that writes samples far larger than any of ours: they take no memory, and all others arrive.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "common/bus/commands.hpp"
#include "common/bus/qos.hpp"
#include "common/bus/raw_bus.hpp"
#include "common/msg/largest_sample.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/patterns.hpp"
#include "tests/component/bus/peer_process.hpp"
#include "tests/support/sanitizers.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;

double own_memory_mb() {
  std::ifstream status("/proc/self/status");
  std::string word;
  double kib = 0;
  while (status >> word && word != "RssAnon:") {
  }
  status >> kib;
  return kib / 1024;
}

/// The largest memory of this process since it was created.
class PeakMemory {
 public:
  double mb() const { return peak_mb_; }

 private:
  std::atomic<double> peak_mb_{own_memory_mb()};
  std::jthread thread_{[this](const std::stop_token& ended) {
    while (!ended.stop_requested()) {
      if (const double now_mb = own_memory_mb(); now_mb > peak_mb_) peak_mb_ = now_mb;
      std::this_thread::sleep_for(2ms);
    }
  }};
};

class LargeSamples : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { wait_matched(status_reader_, feature_reader_, status_, features_); }
  /// Writes features while the peer sends its samples of so many MB; returns how many.
  int features_while_peer_sends(int mb) {
    const PeerProcess peer(GetParam(), "send_large", test_domain(), mb);
    int sent = 0;
    for (; sent < 6000 && done_.size() == 0; ++sent) {
      auto features = features_.loan();
      fill_features(*features, static_cast<std::uint64_t>(sent));
      features_.write(std::move(features));
      std::this_thread::sleep_for(10ms);
    }
    EXPECT_NE(done_.try_next(1ms), nullptr) << "the peer is stuck";
    return sent;
  }

  std::shared_ptr<Bus> bus_ = connect_to(GetParam()), honest_ = connect_to(GetParam());
  Collector<msg::ServiceStatus> statuses_;
  std::atomic<int> received_{0};  ///< features
  Collector<msg::TrackingResult> done_;
  Reader<msg::ServiceStatus> status_reader_ = bus_->reader(topics::kStatus, statuses_.callback());
  Reader<msg::FeatureFrame> feature_reader_ = bus_->reader(topics::kFeatures, [this](const auto&) { ++received_; });
  Reader<msg::TrackingResult> done_reader_ = bus_->reader(topics::kTracking, done_.callback());
  CommandServer server_{*bus_, "test/large", CommandKind::kText, [](const CommandRequest&) {
                          return CommandAnswer{true, "done"};
                        }};
  Writer<msg::ServiceStatus> status_ = honest_->writer(topics::kStatus);
  Writer<msg::FeatureFrame> features_ = honest_->writer(topics::kFeatures);
};

TEST_P(LargeSamples, take_no_memory_and_hold_up_no_other) {
  constexpr double kMostMb = 64, kLeftMb = 32;
  for (const int mb : {20, 60, 100}) {
    const double before_mb = own_memory_mb();
    const PeakMemory peak;
    const int sent = features_while_peer_sends(mb);
    if (!test_support::kSanitized) {  // they keep what is freed
      EXPECT_LE(peak.mb() - before_mb, kMostMb) << "samples of " << mb << " MB";
      EXPECT_LE(own_memory_mb() - before_mb, kLeftMb) << "is given back";
    }
    EXPECT_GE(received_.exchange(0), 0.9 * sent);
    EXPECT_EQ(statuses_.size(), 0U);
    ASSERT_TRUE(status_.write({.service = "filter"}));
    EXPECT_EQ(statuses_.next()->service, "filter");
  }
}

TEST_P(LargeSamples, are_not_written_by_us) {
  constexpr std::size_t kTooLong = msg::largest_sample<msg::ServiceStatus>();
  EXPECT_FALSE(status_.write({.service = "filter", .message = std::string(kTooLong, 'x')}));
  for (int i = 0; i < 1000 && honest_->troubles()[topics::kStatus.name].too_large == 0; ++i)
    std::this_thread::sleep_for(1ms);
  EXPECT_EQ(honest_->troubles()[topics::kStatus.name].too_large, 1U);
  EXPECT_TRUE(status_.write({.service = "filter"}));
  EXPECT_EQ(statuses_.next()->message, "");
}

INSTANTIATE_TEST_SUITE_P(Vendors, LargeSamples, ::testing::ValuesIn(dds_vendors()), test_name);

// Another program on our topics: samples of the right type name with the wrong bytes, from each vendor to
// each.

using Bytes = std::vector<std::uint8_t>;

class MalformedSamples : public ::testing::TestWithParam<std::tuple<std::string, std::string>> {
 protected:
  /// Sends malformed samples, then expects a good one of ours to arrive all the same, and the others to be counted.
  template <class T>
  static void expect_survival(const Topic<T>& topic, const char* type_name, const std::vector<Bytes>& malformed,
                              const T& good) {
    const auto other = connect_raw(options_of(std::get<0>(GetParam())));
    const auto bus = connect(options_of(std::get<1>(GetParam())));
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
  BusOptions theirs = options_of(std::get<0>(GetParam())), ours = options_of(std::get<1>(GetParam()));
  theirs.shared_memory = ours.shared_memory = false;
  ours.network.max_datagram_bytes = 1400;
  const auto other = connect(theirs), bus = connect(ours);
  Collector<msg::CompressedImage> received;
  const auto reader = bus->reader(topics::kColorJpeg, received.callback());
  auto writer = other->writer(topics::kColorJpeg);
  wait_matched(reader, writer);
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
