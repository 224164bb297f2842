// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Raw endpoints among themselves, with every vendor.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "common/bus/raw_bus.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/peer_process.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"

namespace rtd::bus {
namespace {

using test_support::eventually;
using namespace std::chrono_literals;
using Samples = Collector<RawSample>;

const RawTopic kTopic{"rt/unknown/thing", "unknown_msgs::msg::dds_::Thing_"};

std::vector<std::byte> cdr(std::uint32_t number, std::size_t size = 64) {
  std::vector<std::byte> bytes(size, std::byte{0x5a});
  const std::uint8_t header[] = {0, 1, 0, 0};
  std::memcpy(bytes.data(), header, sizeof(header));
  std::memcpy(bytes.data() + 4, &number, std::min(sizeof(number), size - 4));
  return bytes;
}

std::uint32_t number_of(const RawSample& sample) {
  std::uint32_t number = 0;
  std::memcpy(&number, sample.cdr().data() + 4, sizeof(number));
  return number;
}

class RawTopics : public ::testing::TestWithParam<std::string> {
 protected:
  static std::shared_ptr<RawBus> connect_one() { return connect_raw(options_of(GetParam(), "raw-test")); }
};

TEST_P(RawTopics, readers_are_known_by_the_name_of_their_connection_until_they_go) {
  const auto from = connect_one(), to = connect_one();
  Samples samples;
  auto reader = to->reader(kTopic, {}, into(samples));
  std::optional<TopicReader> seen;
  const auto look = [&] {
    seen.reset();
    for (const TopicReader& other : from->readers())
      if (other.topic.name == kTopic.name) seen = other;
    return seen.has_value();
  };
  ASSERT_TRUE(eventually(look));
  EXPECT_EQ(seen->topic, kTopic);
  EXPECT_FALSE(seen->own);
  if (GetParam() != kInprocess) {
    EXPECT_EQ(from->participants()[participant_of(seen->id)], "raw-test");
  }
  reader.reset();
  EXPECT_TRUE(eventually([&] { return !look(); }));
}

TEST_P(RawTopics, bytes_arrive_as_they_were_written) {
  const auto from = connect_one(), to = connect_one();
  Samples samples;
  const auto writer = from->writer(kTopic, {});
  const auto reader = to->reader(kTopic, {}, into(samples));
  wait_matched(*writer, *reader);

  const std::vector<std::size_t> sizes = {5, 64, 100'003, 3'000'000, 8};
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const auto sent = cdr(static_cast<std::uint32_t>(i), sizes[i]);
    ASSERT_TRUE(writer->write(sent));
    const auto sample = samples.next();
    const bool filled_up = GetParam() == "fastdds" && sizes[i] == 5;  // to four bytes, but not in fragments
    ASSERT_EQ(sample->cdr().size(), filled_up ? 8 : sizes[i]);
    EXPECT_EQ(std::memcmp(sample->cdr().data(), sent.data(), sizes[i]), 0);
    EXPECT_EQ(sample->sequence, static_cast<std::int64_t>(i) + 1);
    EXPECT_GE(sample->received_ns, sample->source_ns);
    EXPECT_GT(sample->source_ns, 1'600'000'000'000'000'000);
  }
}

TEST_P(RawTopics, a_given_source_time_is_what_readers_get) {
  const auto from = connect_one(), to = connect_one();
  Samples samples;
  const auto writer = from->writer(kTopic, {});
  const auto reader = to->reader(kTopic, {}, into(samples));
  wait_matched(*writer, *reader);

  constexpr std::int64_t kThen = 1'300'000'000'123'456'789;
  ASSERT_TRUE(writer->write(cdr(1), kThen));
  EXPECT_NEAR(static_cast<double>(samples.next()->source_ns - kThen), 0.0, 1.0);  // RTPS counts 2^-32 s
}

TEST_P(RawTopics, a_late_reader_gets_the_history_if_it_asks) {
  const auto from = connect_one(), to = connect_one();
  RawQos qos;
  qos.durability = RawQos::Durability::kTransientLocal;
  qos.depth = 5;
  const auto writer = from->writer(kTopic, {qos});
  for (std::uint32_t i = 0; i < 8; ++i) ASSERT_TRUE(writer->write(cdr(i)));

  Samples samples;
  RawReaderOptions options;
  options.transient_local = true;
  const auto reader = to->reader(kTopic, options, into(samples));
  for (std::uint32_t i = 3; i < 8; ++i) EXPECT_EQ(number_of(*samples.next()), i);
}

TEST_P(RawTopics, what_a_slow_reader_missed_is_named) {
  const auto from = connect_one(), to = connect_one();
  Samples samples;
  std::mutex mutex;
  std::vector<RawLoss> losses;
  std::unique_lock gate(mutex);
  RawHandlers handlers = into(samples);
  handlers.on_sample = [&, push = handlers.on_sample](RawSample sample) {
    push(std::move(sample));
    const std::lock_guard wait(mutex);
  };
  handlers.on_lost = [&](const RawLoss& loss) {
    const std::lock_guard lock(mutex);
    losses.push_back(loss);
  };
  const auto writer = from->writer(kTopic, {});
  RawReaderOptions options;
  options.depth = 2;
  const auto reader = to->reader(kTopic, options, handlers);
  wait_matched(*writer, *reader);

  ASSERT_TRUE(writer->write(cdr(0)));
  samples.next();  // its handler waits at the gate
  for (std::uint32_t i = 1; i < 10; ++i) ASSERT_TRUE(writer->write(cdr(i)));
  std::this_thread::sleep_for(50ms);
  gate.unlock();

  const auto after = samples.next();
  const std::lock_guard lock(mutex);
  ASSERT_FALSE(losses.empty());
  EXPECT_EQ(losses.front().first_sequence, 2);
  EXPECT_EQ(losses.front().first_sequence + static_cast<std::int64_t>(losses.front().count), after->sequence);
  EXPECT_EQ(losses.front().writer, after->writer);
}

TEST_P(RawTopics, writers_are_announced_with_their_qos_and_gone_again) {
  const auto from = connect_one(), to = connect_one();
  struct Event {
    TopicWriter writer;
    WriterChange change;
  };
  Collector<Event> events;
  RawQos qos;
  qos.reliable = false;
  qos.durability = RawQos::Durability::kTransientLocal;
  qos.depth = 3;
  qos.deadline_ns = 250'000'000;
  qos.liveliness_lease_ns = 2'000'000'000;
  to->watch([&](const TopicWriter& writer, WriterChange change) {
    if (writer.topic.name == kTopic.name) events.push(std::make_shared<const Event>(Event{writer, change}));
  });
  auto writer = from->writer(kTopic, {qos});

  const auto appeared = events.next();
  EXPECT_EQ(appeared->change, WriterChange::kAppeared);
  EXPECT_EQ(appeared->writer.topic.type, kTopic.type);
  qos.depth = appeared->writer.qos.depth;  // is not announced over DDS
  EXPECT_EQ(appeared->writer.qos, qos);
  writer.reset();
  EXPECT_EQ(events.next()->change, WriterChange::kGone);
  to->watch(nullptr);
}

TEST_P(RawTopics, a_reader_that_asks_for_more_than_is_offered_gets_nothing) {
  const auto from = connect_one(), to = connect_one();
  RawQos best_effort;
  best_effort.reliable = false;
  const auto writer = from->writer(kTopic, {best_effort});
  Samples none, all;
  RawReaderOptions modest;
  modest.reliable = false;
  const auto greedy = to->reader(kTopic, {}, into(none));
  const auto reader = to->reader(kTopic, modest, into(all));
  wait_matched(*writer, *reader);
  ASSERT_TRUE(writer->write(cdr(7)));
  EXPECT_EQ(number_of(*all.next()), 7U);
  EXPECT_EQ(none.size(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Vendors, RawTopics, ::testing::ValuesIn(inprocess::all_vendors()), test_name);

TEST(SequenceGaps, counts_begin_with_the_first_number_received) {
  SequenceGaps gaps;
  const WriterId a{1}, b{2};
  EXPECT_FALSE(gaps.next(a, 100));
  EXPECT_FALSE(gaps.next(a, 101));
  EXPECT_FALSE(gaps.next(b, 5));
  const auto loss = gaps.next(a, 105);
  ASSERT_TRUE(loss);
  EXPECT_EQ(loss->first_sequence, 102);
  EXPECT_EQ(loss->count, 3U);
  EXPECT_FALSE(gaps.next(b, 6));
  EXPECT_FALSE(gaps.next(a, 103)) << "late is not lost";
  EXPECT_FALSE(gaps.next(a, 106));
}

}  // namespace
}  // namespace rtd::bus
