// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// A message comes with the id of its writer, with every vendor and across them.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/bus/bus_factory.hpp"
#include "tests/component/bus/collector.hpp"
#include "tests/component/bus/patterns.hpp"
#include "tests/component/bus/peer_process.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"

namespace rtd::bus {
namespace {

using namespace std::chrono_literals;

/// Each side matches on its own.
template <class T>
void wait_for_match(const Reader<T>& reader, const std::vector<const Writer<T>*>& writers) {
  const auto all = [&] {
    return reader.matched() == static_cast<int>(writers.size()) &&
           std::ranges::all_of(writers, [](const Writer<T>* writer) { return writer->matched() > 0; });
  };
  for (int i = 0; !all(); ++i) {
    ASSERT_LT(i, 5000) << "not matched";
    std::this_thread::sleep_for(1ms);
  }
}

/// One message as its reader got it.
struct Arrival {
  std::uint64_t seq = 0;
  WriterId writer{};
};

/// A change of the writers that a reader is matched with.
struct Change {
  WriterId writer{};
  bool matched = false;
};

class WriterIds : public ::testing::TestWithParam<std::pair<std::string, std::string>> {
 protected:
  template <class T>
  Reader<T> listen(const Topic<T>& topic, StatusCallbacks callbacks = {}) {
    callbacks.on_writer = [this](const WriterId& id, bool matched) {
      changes.push(std::make_shared<const Change>(id, matched));
    };
    return there->reader(
        topic,
        [this](const std::shared_ptr<const T>& message, const WriterId& writer) {
          arrivals.push(std::make_shared<const Arrival>(message->seq, writer));
        },
        std::move(callbacks));
  }
  template <class T>
  static void write(Writer<T>& writer, std::uint64_t seq) {
    if constexpr (std::is_same_v<T, msg::RgbdFrame>) {
      auto frame = writer.loan();
      fill_frame(*frame, seq);
      EXPECT_TRUE(writer.write(std::move(frame)));
    } else {
      EXPECT_TRUE(writer.write(T{.seq = seq}));
    }
  }

  /// What is written right after the match may be lost between vendors, so more is written until one arrives; then all
  /// have.
  template <class T>
  Arrival first_arrival(Writer<T>& writer) {
    for (std::uint64_t seq = 0; seq < 50; ++seq) {
      write(writer, seq);
      auto arrival = arrivals.try_next(100ms);
      if (!arrival) continue;
      while (arrival->seq != seq) arrival = arrivals.next();
      return *arrival;
    }
    throw std::runtime_error("no message arrived");
  }

  template <class T>
  void expect_one_taken(const Topic<T>& topic) {
    std::atomic<int> asked{0};
    WriterId wanted{};
    auto one = here->writer(topic), other = here->writer(topic);
    wanted = one.id();
    StatusCallbacks callbacks;
    callbacks.accepts = [&](const WriterId& id) {
      ++asked;
      return id == wanted;
    };
    const auto reader = listen(topic, callbacks);
    wait_for_match<T>(reader, {&one, &other});
    first_arrival(one);
    const int asked_before = asked;
    for (std::uint64_t seq = 1000; seq < 1020; seq += 2) {
      write(other, seq);
      write(one, seq + 1);
      const auto arrival = arrivals.next();
      EXPECT_EQ(arrival->seq, seq + 1);
      EXPECT_EQ(arrival->writer, one.id());
    }
    EXPECT_EQ(arrivals.size(), 0U);
    EXPECT_GE(asked - asked_before, 11);
  }

  Collector<Arrival> arrivals;
  Collector<Change> changes;
  std::shared_ptr<Bus> here = connect_to(GetParam().first), there = connect_to(GetParam().second);
};

TEST_P(WriterIds, come_with_each_message_and_differ) {
  const auto reader = listen(topics::kTracking);
  auto one = here->writer(topics::kTracking), other = here->writer(topics::kTracking);
  wait_for_match<msg::TrackingResult>(reader, {&one, &other});
  EXPECT_NE(one.id(), other.id());
  EXPECT_EQ(participant_of(one.id()), participant_of(other.id()));
  EXPECT_EQ(first_arrival(one).writer, one.id());
  EXPECT_EQ(first_arrival(other).writer, other.id());
}

TEST_P(WriterIds, come_with_frames_through_shared_memory) {
  if (GetParam().first != GetParam().second) GTEST_SKIP() << "a frame does not cross shared memory between vendors";
  const auto reader = listen(topics::kFrame);
  auto writer = here->writer(topics::kFrame);
  wait_for_match<msg::RgbdFrame>(reader, {&writer});
  EXPECT_EQ(first_arrival(writer).writer, writer.id());
}

TEST_P(WriterIds, are_reported_when_writers_come_and_go) {
  const auto reader = listen(topics::kTracking);
  auto writer = std::make_unique<Writer<msg::TrackingResult>>(here->writer(topics::kTracking));
  const WriterId id = writer->id();
  auto change = changes.next();
  EXPECT_EQ(change->writer, id);
  EXPECT_TRUE(change->matched);
  wait_for_match<msg::TrackingResult>(reader, {writer.get()});
  writer.reset();
  here.reset();
  change = changes.next(20s);  // Fast DDS notes the end of one of Cyclone's writers with the lease of its connection
  EXPECT_EQ(change->writer, id);
  EXPECT_FALSE(change->matched);
}

TEST_P(WriterIds, decide_which_messages_are_taken) {
  expect_one_taken(topics::kTracking);
}

TEST_P(WriterIds, decide_which_frames_are_taken) {
  if (GetParam().first != GetParam().second) GTEST_SKIP() << "a frame does not cross shared memory between vendors";
  expect_one_taken(topics::kFrame);
}

TEST_P(WriterIds, lose_next_to_nothing_of_the_wanted_writer_while_another_writes_a_thousand_times_a_second) {
  const auto elsewhere = connect_to(GetParam().first);
  auto one = here->writer(topics::kFeatures), other = elsewhere->writer(topics::kFeatures);
  StatusCallbacks callbacks;
  callbacks.accepts = [wanted = one.id()](const WriterId& id) { return id == wanted; };
  const auto reader = listen(topics::kFeatures, callbacks);
  wait_for_match<msg::FeatureFrame>(reader, {&one, &other});
  const auto features = std::make_unique<msg::FeatureFrame>(), forged = std::make_unique<msg::FeatureFrame>();
  fill_features(*forged, 0);
  const std::jthread flood([&](const std::stop_token& stop) {
    for (; !stop.stop_requested(); std::this_thread::sleep_for(1ms)) other.write(*forged);
  });
  constexpr std::uint64_t kMessages = 3000;
  int lost = 0;
  for (std::uint64_t seq = 1; seq <= kMessages; ++seq) {
    fill_features(*features, seq);
    EXPECT_TRUE(one.write(*features));
    auto arrival = arrivals.try_next(100ms);
    while (arrival && arrival->seq < seq) arrival = arrivals.try_next(100ms);
    if (!arrival) ++lost;
  }
  EXPECT_LE(lost, 10) << "of " << kMessages << "; a history that a busy computer reads too late overflows";
}

std::vector<std::pair<std::string, std::string>> vendor_pairs() {
  std::vector<std::pair<std::string, std::string>> all{{inprocess::vendor(), inprocess::vendor()}};
  for (const std::string& from : dds_vendors())
    for (const std::string& to : dds_vendors()) all.emplace_back(from, to);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Vendors, WriterIds, ::testing::ValuesIn(vendor_pairs()),
                         [](const auto& test) { return test.param.first + "_to_" + test.param.second; });

}  // namespace
}  // namespace rtd::bus
