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

#include "common/bus/commands.hpp"
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
  void SetUp() override {
    const auto matched = [this] {
      return status_reader_.matched() > 0 && feature_reader_.matched() > 0 && status_.matched() > 0 &&
             features_.matched() > 0;
    };
    for (int i = 0; i < 5000 && !matched(); ++i) std::this_thread::sleep_for(1ms);
  }
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

}  // namespace
}  // namespace rtd::bus
