// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/topic_follower.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"

#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <condition_variable>

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr const char* kTopic = "rt/thing";
constexpr const char* kType = "a::msg::dds_::Thing_";

/// A connection that follows, and another one that writes. What the follower reports is a line of `events_`.
class TopicFollowerTest : public ::testing::Test {
 protected:
  static std::shared_ptr<RawBus> connect() {
    BusOptions options;
    options.vendor = inprocess::vendor();
    options.domain = 77;
    return connect_raw(options);
  }
  TopicFollower::Options options(bool on_demand) {
    TopicFollower::Options options;
    options.handlers = [this](const RawTopic&) {
      RawHandlers handlers;
      handlers.on_sample = [this](const RawSample& sample) { add("sample " + std::to_string(sample.cdr().size())); };
      return handlers;
    };
    options.on_gone = [this](const RawTopic& topic) { add("gone " + topic.name); };
    options.on_read = [this](const TopicWriter&, const RawReaderOptions& reader) {
      add(reader.reliable ? "reliable" : "best effort");
    };
    options.run = TopicFollower::under(lock_);
    options.on_demand = on_demand;
    return options;
  }
  std::unique_ptr<RawWriter> writer(bool reliable = true, const std::string& type = kType) {
    return other_->writer({kTopic, type}, {.qos = {.reliable = reliable}});
  }
  void read(TopicFollower& follower, bool wanted) {
    const std::lock_guard lock(lock_);
    follower.read(kTopic, wanted);
  }
  void add(const std::string& event) {
    const std::lock_guard lock(mutex_);
    events_.push_back(event);
    change_.notify_all();
  }
  /// Takes the events when there are so many, or after a second.
  std::vector<std::string> events(std::size_t count) {
    std::unique_lock lock(mutex_);
    change_.wait_for(lock, 1s, [&] { return events_.size() >= count; });
    return std::exchange(events_, {});
  }
  static void send(RawWriter& writer) { writer.write(std::array<std::byte, 8>{}); }

  std::mutex lock_, mutex_;
  std::condition_variable change_;
  std::vector<std::string> events_;
  std::shared_ptr<RawBus> bus_ = connect(), other_ = connect();
};

TEST_F(TopicFollowerTest, reads_all_writers_as_these_offer) {
  TopicFollower follower(*bus_, options(false));
  const auto first = writer();
  EXPECT_THAT(events(1), ElementsAre("reliable"));
  send(*first);
  EXPECT_THAT(events(1), ElementsAre("sample 8"));
  const auto less = writer(false);
  EXPECT_THAT(events(1), ElementsAre("best effort"));
  send(*less);
  EXPECT_THAT(events(1), ElementsAre("sample 8"));
}

TEST_F(TopicFollowerTest, writers_of_another_type_than_the_first_do_not_count) {
  TopicFollower follower(*bus_, options(false));
  const auto first = writer();
  const auto other = writer(true, "a::msg::dds_::Other_");
  const auto second = writer();
  EXPECT_THAT(events(2), ElementsAre("reliable", "reliable"));
  const std::lock_guard lock(lock_);
  EXPECT_EQ(follower.writers(kTopic).size(), 2U);
  EXPECT_THAT(follower.topics(), ElementsAre(kTopic));
  EXPECT_THAT(follower.writers("rt/unknown"), IsEmpty());
}

TEST_F(TopicFollowerTest, on_demand_reads_what_is_wanted_whenever_it_has_writers) {
  TopicFollower follower(*bus_, options(true));
  read(follower, true);
  auto first = writer();
  EXPECT_THAT(events(1), ElementsAre("reliable"));
  first.reset();
  EXPECT_THAT(events(1), ElementsAre("gone rt/thing"));
  first = writer();
  EXPECT_THAT(events(1), ElementsAre("reliable"));
  read(follower, false);
  EXPECT_EQ(first->matched(), 0);
  read(follower, true);
  send(*first);
  EXPECT_THAT(events(2), ElementsAre("reliable", "sample 8"));
}

}  // namespace
}  // namespace rtd::bus
