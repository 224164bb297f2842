// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// rtd/keyframe_request and rtd/keyframe_features as an atlas uses them.
#include "services/slam/keyframe_sender.hpp"

#include <gmock/gmock.h>

#include "common/bus/bus_factory.hpp"
#include "common/ros_codec/wire.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/inbox.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"
#include "tests/support/settled_map.hpp"

namespace rtd::slam {
namespace {

using test_support::FeatureWorld;
using test_support::Inbox;
using namespace std::chrono_literals;

class KeyframeSenderTest : public testing::Test {
 protected:
  KeyframeSenderTest()
      : bus_(bus::connect(options())),
        requests_(bus_->writer(bus::topics::kKeyframeRequest)),
        features_reader_(bus_->reader<msg::KeyframeFeatures>(
            bus::topics::kKeyframeFeatures,
            [inbox = sent_](std::shared_ptr<const msg::KeyframeFeatures> message) { inbox.take(std::move(message)); })),
        map_reader_(bus_->reader<msg::MapUpdate>(
            bus::topics::kMap,
            [inbox = updates_](std::shared_ptr<const msg::MapUpdate> update) { inbox.take(std::move(update)); })) {
    play(150);
    EXPECT_GE(slam_.keyframes().size(), 3U);
  }
  void play(std::uint64_t frames) {
    for (std::uint64_t seq = 0; seq < frames; ++seq) slam_.process(*world_.view(seq));
  }
  /// Session that the map as it is now is published in; it is published no more.
  std::int64_t session() {
    EXPECT_TRUE(updates_.wait_count(1));
    return updates_.all().back()->session_ns;
  }
  bool request(std::int64_t session_ns, std::vector<std::uint32_t> ids) {
    return requests_.write({session_ns, std::move(ids)});
  }
  std::vector<std::uint32_t> ids() const {
    std::vector<std::uint32_t> ids;
    for (const auto& message : sent_.all()) ids.push_back(message->keyframe_id);
    return ids;
  }
  ServiceConfig at(int bytes_per_s) const {
    ServiceConfig config;
    config.atlas.bytes_per_s = bytes_per_s;
    return config;
  }

  static constexpr int kUnlimited = 1'000'000'000;
  const FeatureWorld world_{{}};
  SlamSystem slam_{test_support::settled(), MappingMode::kSynchronous, test_support::frozen_clock};
  const std::shared_ptr<bus::Bus> bus_;
  Inbox<msg::KeyframeFeatures> sent_;
  Inbox<msg::MapUpdate> updates_;
  bus::Writer<msg::KeyframeRequest> requests_;
  bus::Reader<msg::KeyframeFeatures> features_reader_;
  bus::Reader<msg::MapUpdate> map_reader_;

 private:
  static bus::BusOptions options() {
    static std::uint32_t domain = 80;
    bus::BusOptions options;
    options.vendor = bus::inprocess::vendor();
    options.domain = domain++;
    return options;
  }
};

TEST_F(KeyframeSenderTest, sends_the_keyframes_that_are_asked_for_in_their_order) {
  MapPublisher publisher(
      *bus_, [&] { return slam_.map_view(); }, 1ms);
  KeyframeSender sender(*bus_, at(kUnlimited), slam_, publisher);
  ASSERT_TRUE(request(session(), {2, 99999, 1}));
  ASSERT_TRUE(sent_.wait_count(2));
  EXPECT_THAT(ids(), testing::ElementsAre(2, 1));
  const msg::KeyframeFeatures& message = *sent_.all().back();
  EXPECT_EQ(message.session_ns, session());
  const FramePtr frame = slam_.read_map([](const Map& map) { return map.find_keyframe(1)->frame; });
  EXPECT_EQ(message.stamp_ns, frame->stamp_ns);
  EXPECT_EQ(message.features.size(), world_.view(frame->seq)->count);
}

TEST_F(KeyframeSenderTest, passes_over_what_is_asked_of_another_session) {
  MapPublisher publisher(
      *bus_, [&] { return slam_.map_view(); }, 1ms);
  KeyframeSender sender(*bus_, at(kUnlimited), slam_, publisher);
  ASSERT_TRUE(request(session() - 1, {0}));
  EXPECT_FALSE(sent_.wait_count(1, 100ms));
  ASSERT_TRUE(request(session(), {1}));
  ASSERT_TRUE(sent_.wait_count(1));
  EXPECT_THAT(ids(), testing::ElementsAre(1));
}

TEST_F(KeyframeSenderTest, sends_nothing_of_a_map_that_has_not_been_published) {
  const MapView published = slam_.map_view();
  MapPublisher publisher(
      *bus_, [&] { return published; }, 1ms);
  KeyframeSender sender(*bus_, at(kUnlimited), slam_, publisher);
  slam_.reset();
  play(10);
  ASSERT_TRUE(request(session(), {0}));
  EXPECT_FALSE(sent_.wait_count(1, 100ms)) << "a keyframe of the new map, with an id of the old one";
}

TEST_F(KeyframeSenderTest, keeps_to_its_rate_and_the_newest_request_counts) {
  constexpr int kBytesPerS = 1'000'000;
  MapPublisher publisher(
      *bus_, [&] { return slam_.map_view(); }, 1ms);
  KeyframeSender sender(*bus_, at(kBytesPerS), slam_, publisher);
  const std::int64_t session_ns = session();
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(request(session_ns, std::vector<std::uint32_t>(1000, 0)));
  ASSERT_TRUE(sent_.wait_count(4));
  ASSERT_TRUE(request(session_ns, {1}));
  ASSERT_TRUE(sent_.wait([](const auto& all) { return all.back()->keyframe_id == 1; }));
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  std::size_t bytes = 0;
  const auto sent = sent_.all();
  for (std::size_t i = 0; i + 1 < sent.size(); ++i) bytes += ros::encoded_size<ros::Wire::kCdr>(*sent[i]);
  EXPECT_GT(elapsed.count(), 0.99 * static_cast<double>(bytes) / kBytesPerS) << "s";
  ASSERT_TRUE(request(session_ns, {2}));
  ASSERT_TRUE(sent_.wait([](const auto& all) { return all.back()->keyframe_id == 2; }));
  EXPECT_EQ(ids()[ids().size() - 2], 1U) << "the rest of the first request is forgotten";
}

}  // namespace
}  // namespace rtd::slam
