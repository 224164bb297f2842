// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Each vendor to each, as two processes, over every topic: all arrives, byte by byte, in order; late readers get what
// is kept for them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>
#include <tuple>

#include "common/bus/bus_factory.hpp"
#include "common/bus/topic_roles.hpp"
#include "common/msg/imu.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/interop/bus/all_topics.hpp"
#include "tests/interop/bus/talking_process.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::bus::interop {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

/// What the readers of all topics get, as bytes by topic.
class Readers {
 public:
  enum class Which { kAll, kTransientLocal };

  Readers(Bus& bus, Which which) {
    for_each_topic([&]<class T>(const Topic<T>& topic) {
      if (which == Which::kTransientLocal && !qos_settings(topic.profile).transient_local) return;
      Collector<Bytes>& received = received_[topic.name];
      auto reader = std::make_shared<Reader<T>>(bus.reader(topic, [&received](std::shared_ptr<const T> message) {
        received.push(std::make_shared<const Bytes>(bytes_of(*message)));
      }));
      matched_.emplace_back([reader] { return reader->matched(); });
    });
  }
  bool all_matched() const {
    for (int i = 0; i < 20'000; ++i) {
      if (std::all_of(matched_.begin(), matched_.end(), [](const auto& matched) { return matched() > 0; })) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }
  /// A volatile reader of Cyclone begins with the first heartbeat that it gets of another vendor's writer after both
  /// have matched. So round 0 is sent until each topic has brought something; it may be received again later.
  void wait_until_received(const std::function<void()>& send_probe) {
    for (auto& [topic, received] : received_) {
      for (int i = 0; i < 200 && received.size() == 0; ++i) {
        send_probe();
        std::this_thread::sleep_for(50ms);
      }
    }
  }
  /// Expects the message of that number as the topic's next after those of round 0.
  template <class T>
  void expect_next(const Topic<T>& topic, int number) {
    const Bytes expected = bytes_of(*message_of(topic, number));
    std::shared_ptr<const Bytes> received;
    do {
      received = received_.at(topic.name).try_next(10s);
      ASSERT_NE(received, nullptr) << topic.name << ": message " << number << " did not arrive";
    } while (*received != expected && is_of_round_0(topic, *received));
    ASSERT_TRUE(*received == expected) << topic.name << ": message " << number << ": " << what_came(topic, *received);
  }
  std::size_t waiting(const char* topic) { return received_.at(topic).size(); }

 private:
  template <class T>
  static std::string what_came(const Topic<T>& topic, const Bytes& bytes) {
    for (int other = 0; other < 1000; ++other) {
      if (bytes == bytes_of(*message_of(topic, other))) return "number " + std::to_string(other) + " came instead";
    }
    return "it arrived changed";
  }
  template <class T>
  static bool is_of_round_0(const Topic<T>& topic, const Bytes& bytes) {
    for (int i = 0; i < burst(topic.profile); ++i) {
      if (bytes == bytes_of(*message_of(topic, i))) return true;
    }
    return false;
  }

  std::map<std::string, Collector<Bytes>> received_;
  std::vector<std::function<int()>> matched_;  // these own the readers, so they go first
};

/// RTD_INTEROP_ROUNDS=500 for the long campaign.
int rounds() {
  const char* asked = std::getenv("RTD_INTEROP_ROUNDS");
  return asked != nullptr ? std::atoi(asked) : 8;
}

class VendorMatrix : public testing::TestWithParam<std::tuple<std::string, std::string>> {
 protected:
  const std::uint32_t domain = test_domain();

  std::shared_ptr<Bus> connect_reading() const {
    BusOptions options;
    options.vendor = std::get<1>(GetParam());
    options.domain = domain;
    options.participant_name = "interop-test";
    return connect(options);
  }
  /// RTD_INTEROP_PEER: another program, e.g. one that starts the peer of another system (docs/platforms.md).
  std::vector<std::string> peer(const char* role) const {
    const char* other = std::getenv("RTD_INTEROP_PEER");
    return {other != nullptr ? other : INTEROP_PEER_PATH, std::get<0>(GetParam()), std::to_string(domain), role};
  }
};

TEST_P(VendorMatrix, every_message_of_every_topic_arrives_with_every_byte) {
  const auto bus = connect_reading();
  Readers readers(*bus, Readers::Which::kAll);
  test_support::TalkingProcess writing(peer("live"));
  ASSERT_TRUE(readers.all_matched());
  ASSERT_EQ(writing.receive(), "ready");
  readers.wait_until_received([&] { writing.send("0"); });
  // On a loaded machine many may still be on their way, and would push messages of round 1 out of the histories.
  writing.send("wait");
  ASSERT_EQ(writing.receive(), "acknowledged");

  for (int round = 1; round <= rounds() && !HasFatalFailure(); ++round) {
    writing.send(std::to_string(round));
    for_each_topic([&](const auto& topic) {
      const int count = burst(topic.profile);
      for (int i = 0; i < count && !HasFatalFailure(); ++i) readers.expect_next(topic, round * count + i);
    });
  }
  for_each_topic([&](const auto& topic) { EXPECT_EQ(readers.waiting(topic.name), 0U) << topic.name; });
}

TEST_P(VendorMatrix, late_readers_get_what_is_kept_for_them) {
  test_support::TalkingProcess writing(peer("late"));
  ASSERT_EQ(writing.receive(), "ready");
  const auto bus = connect_reading();
  Readers readers(*bus, Readers::Which::kTransientLocal);
  for_each_topic([&](const auto& topic) {
    if (!qos_settings(topic.profile).transient_local) return;
    const int count = kept(topic.profile);
    for (int i = 0; i < count && !HasFatalFailure(); ++i) readers.expect_next(topic, kForgotten + i);
    EXPECT_EQ(readers.waiting(topic.name), 0U) << topic.name;
  });
}

INSTANTIATE_TEST_SUITE_P(Pairs, VendorMatrix,
                         testing::Combine(testing::ValuesIn(dds_vendors()), testing::ValuesIn(dds_vendors())),
                         [](const auto& test) { return std::get<0>(test.param) + "_to_" + std::get<1>(test.param); });

TEST(VendorMatrixTopics, are_all_that_services_write) {
  std::vector<std::string> names, written;
  for_each_topic([&](const auto& topic) { names.emplace_back(topic.name); });
  for (const TopicRoles& roles : topic_roles()) {
    const bool pattern = roles.topic.find('*') != std::string::npos || is_internal_to_ros(roles.topic);
    const bool by_services = !roles.writers.empty() && roles.writers.front() != "observer";
    const bool as_bytes = roles.topic == msg::kImuTopic || roles.topic == msg::kWheelTopic;  // common/msg/imu.hpp
    if (!pattern && by_services && !as_bytes) written.push_back(roles.topic);
  }
  EXPECT_THAT(names, testing::UnorderedElementsAreArray(written));
}

}  // namespace
}  // namespace rtd::bus::interop
