// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <random>

#include "common/service/peer_clocks.hpp"

namespace rtd::service {
namespace {

using ::testing::IsEmpty;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kEpochNs = 1'790'000'000'000'000'000;

/// A service on a host whose clock is `ahead_ns` of true time.
struct Service {
  std::string name;
  double host_id;
  std::int64_t ahead_ns;
  PeerClocks clocks{name, host_id};
  std::vector<msg::Metric> metrics{};

  msg::ServiceStatus status(std::int64_t true_ns) const {
    msg::ServiceStatus status;
    status.service = name;
    status.stamp_ns = true_ns + ahead_ns;
    status.metrics = metrics;
    status.metrics.push_back({"host_id", host_id});
    return status;
  }
  void receive(const Service& other, std::int64_t sent_ns, std::int64_t delay_ns) {
    metrics = clocks.received(other.status(sent_ns), sent_ns + delay_ns + ahead_ns);
  }
  double metric(const std::string& key) const {
    for (const msg::Metric& candidate : metrics)
      if (candidate.name == key) return candidate.value;
    return std::nan("");
  }
};

/// Heartbeats both ways for `seconds`, 5 a second, each delayed by 0.2 ms and a queue of up to 20 ms.
void talk(Service& a, Service& b, int seconds, std::int64_t from_ns = kEpochNs) {
  std::mt19937 random(1);
  std::exponential_distribution<double> queue_ms(0.3);
  for (int i = 0; i < 5 * seconds; ++i) {
    const std::int64_t now_ns = from_ns + i * 200 * kMs;
    const auto delay_ns = [&] { return 200'000 + static_cast<std::int64_t>(std::min(20.0, queue_ms(random)) * 1e6); };
    b.receive(a, now_ns, delay_ns());
    a.receive(b, now_ns + 70 * kMs, delay_ns());
  }
}

TEST(PeerClocks, both_hosts_find_the_same_offset_behind_queues) {
  for (const std::int64_t ahead_ns : {0L, 250 * kMs, -3'600'000 * kMs}) {
    Service camera{"camera", 1, 0}, detector{"detector", 2, ahead_ns};
    talk(camera, detector, 20);
    const double ahead_ms = static_cast<double>(ahead_ns) / 1e6;
    EXPECT_NEAR(camera.metric("clock.detector.offset_ms"), ahead_ms, 0.5);
    EXPECT_NEAR(detector.metric("clock.camera.offset_ms"), -ahead_ms, 0.5);
    EXPECT_NEAR(camera.metric("clock.detector.round_trip_ms"), 0.4, 0.5);
  }
}

TEST(PeerClocks, a_clock_that_was_set_is_accepted_within_a_minute) {
  Service camera{"camera", 1, 0}, detector{"detector", 2, 500 * kMs};
  talk(camera, detector, 20);
  detector.ahead_ns = 0;
  talk(camera, detector, 70, kEpochNs + 20'000 * kMs);
  EXPECT_NEAR(camera.metric("clock.detector.offset_ms"), 0, 0.5);
}

TEST(PeerClocks, services_of_one_host_have_one_clock) {
  Service camera{"camera", 1, 0}, detector{"detector", 1, 0};
  talk(camera, detector, 2);
  EXPECT_THAT(camera.metrics, IsEmpty());
}

TEST(PeerClocks, a_service_without_a_host_id_is_not_compared) {
  Service camera{"camera", 1, 0};
  msg::ServiceStatus old_version;
  old_version.service = "detector";
  EXPECT_THAT(camera.clocks.received(old_version, kEpochNs), IsEmpty());
}

TEST(PeerClocks, the_id_of_a_host_is_a_whole_number_that_stays) {
  EXPECT_EQ(PeerClocks::this_host_id(), PeerClocks::this_host_id());
  EXPECT_EQ(PeerClocks::this_host_id(), std::floor(PeerClocks::this_host_id()));
}

}  // namespace
}  // namespace rtd::service
