// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
/// rtd/map as viewers read it: whoever comes when, all end up with the same map.
#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <numbers>

#include "common/bus/bus_factory.hpp"
#include "common/msg/transform_eigen.hpp"
#include "common/ros_codec/wire.hpp"
#include "services/slam/core/slam_system.hpp"
#include "services/slam/keyframe_sender.hpp"
#include "services/slam/map_publisher.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/inbox.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"
#include "tests/support/settled_map.hpp"
#include "tests/support/walk_world.hpp"

namespace rtd::slam {
namespace {

using test_support::FeatureWorld;
using test_support::Inbox;
using test_support::WalkWorld;
using namespace std::chrono_literals;

/// What a viewer makes of the updates.
struct ViewerMap {
  std::int64_t session_ns = 0;
  std::uint64_t revision = 0;
  std::map<std::uint32_t, msg::MapKeyframe> keyframes;
  std::vector<std::uint32_t> loop_edges;

  void apply(const msg::MapUpdate& update) {
    if (update.session_ns != session_ns) *this = {update.session_ns, 0, {}, {}};
    revision = update.revision;
    loop_edges = update.loop_edges;
    for (const msg::MapKeyframe& entry : update.keyframes) {
      if ((entry.content & msg::kMapRemoved) != 0) {
        keyframes.erase(entry.keyframe_id);
        continue;
      }
      msg::MapKeyframe& kept = keyframes[entry.keyframe_id];
      kept.T_world_camera = entry.T_world_camera;
      kept.map_id = entry.map_id;
      if ((entry.content & msg::kMapPoints) != 0) kept.points_m = entry.points_m;
      if ((entry.content & msg::kMapEdges) != 0) kept.covisible = entry.covisible;
    }
  }
  std::size_t points() const {
    std::size_t numbers = 0;
    for (const auto& [id, keyframe] : keyframes) numbers += keyframe.points_m.size();
    return numbers / 3;
  }
};

ViewerMap map_of(const std::vector<std::shared_ptr<const msg::MapUpdate>>& updates) {
  ViewerMap map;
  for (const auto& update : updates) map.apply(*update);
  return map;
}

std::size_t bytes_of(const msg::MapUpdate& update) {
  return ros::encoded_size<ros::Wire::kCdr>(update);
}

class MapPublisherTest : public testing::Test {
 protected:
  static constexpr std::chrono::milliseconds kPeriod{20};

  MapPublisherTest() : bus_(bus::connect(options())) {}

  bus::Reader<msg::MapUpdate> read(const Inbox<msg::MapUpdate>& inbox) {
    return bus_->reader<msg::MapUpdate>(
        bus::topics::kMap, [inbox](std::shared_ptr<const msg::MapUpdate> update) { inbox.take(std::move(update)); });
  }
  /// True once the reader's map is the view's, within what is not reported.
  static bool wait_same(const Inbox<msg::MapUpdate>& inbox, const MapView& view) {
    return inbox.wait([&](const auto& updates) { return is_same(map_of(updates), view); });
  }
  static bool is_same(const ViewerMap& map, const MapView& view) {
    if (map.keyframes.size() != view.keyframes.size() || map.loop_edges != view.loop_edges) return false;
    for (const KeyframeView& keyframe : view.keyframes) {
      const auto found = map.keyframes.find(keyframe.id);
      if (found == map.keyframes.end()) return false;
      const msg::MapKeyframe& kept = found->second;
      const Eigen::Isometry3d T = msg::to_isometry(kept.T_world_camera).inverse() * keyframe.T_world_camera;
      if (T.translation().norm() > 2e-4 || kept.points_m.size() != 3 * keyframe.points_m.size() ||
          kept.covisible != keyframe.covisible) {
        return false;
      }
    }
    return true;
  }

  const std::shared_ptr<bus::Bus> bus_;

 private:
  static bus::BusOptions options() {
    static std::uint32_t domain = 60;
    bus::BusOptions options;
    options.vendor = bus::inprocess::vendor();
    options.domain = domain++;
    return options;
  }
};

SlamSystem make_slam() {
  SlamConfig config = test_support::settled();
  config.sensor.calibration_error = 0;
  return {config, MappingMode::kSynchronous, test_support::frozen_clock};
}

TEST_F(MapPublisherTest, a_late_reader_gets_the_same_map_as_an_early_one) {
  SlamSystem slam = make_slam();
  MapPublisher publisher(
      *bus_, [&] { return slam.map_view(); }, kPeriod);
  Inbox<msg::MapUpdate> early, late;
  const auto early_reader = read(early);
  const test_support::FeatureWorld world = test_support::FeatureWorld::noisy();
  SlamOutput output;
  std::uint64_t seq = 0;
  for (; seq < 60; ++seq) output = slam.process(*world.view(seq));
  ASSERT_TRUE(wait_same(early, slam.map_view()));
  const auto late_reader = read(late);
  for (; seq < 120; ++seq) output = slam.process(*world.view(seq));
  EXPECT_TRUE(wait_same(early, slam.map_view()));
  EXPECT_TRUE(wait_same(late, slam.map_view()));
  EXPECT_EQ(map_of(late.all()).points(), output.result.landmarks);
  EXPECT_EQ(map_of(early.all()).session_ns, map_of(late.all()).session_ns);
  for (const auto& update : early.all()) EXPECT_LT(bytes_of(*update), 100'000U);
}

TEST_F(MapPublisherTest, is_silent_while_the_map_rests_and_copies_nothing_without_a_reader) {
  SlamSystem slam = make_slam();
  std::atomic<int> copies{0};
  MapPublisher publisher(
      *bus_,
      [&] {
        ++copies;
        return slam.map_view();
      },
      kPeriod);
  const test_support::FeatureWorld world({});
  for (std::uint64_t seq = 0; seq < 30; ++seq) slam.process(*world.view(seq));
  EXPECT_EQ(copies, 0);
  Inbox<msg::MapUpdate> inbox;
  const auto reader = read(inbox);
  ASSERT_TRUE(wait_same(inbox, slam.map_view()));
  // The first update, and all of it once more when the match has settled.
  ASSERT_TRUE(inbox.wait([](const auto& all) {
    return std::ranges::count_if(all, [](const auto& update) { return !update->keyframes.empty(); }) >= 2;
  }));
  const std::size_t reported = inbox.all().size();
  const int copied = copies;
  while (copies < copied + 10) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(inbox.all().size(), reported);
}

std::size_t bytes_of(const std::vector<msg::MapUpdate>& updates) {
  std::size_t bytes = 0;
  for (const msg::MapUpdate& update : updates) bytes += bytes_of(update);
  return bytes;
}

/// A lap of a camera whose calibration is 2 % off: each turn is over-estimated until the loop is closed.
Eigen::Isometry3d pose_on_circle(int i) {
  constexpr double kLapRadiusM = 6;
  const double angle_rad = i * 0.2 / kLapRadiusM;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T.translation() = kLapRadiusM * Eigen::Vector3d(1 - std::cos(angle_rad), 0, std::sin(angle_rad));
  return T;
}

TEST(MapUpdates, a_closed_loop_costs_poses_only) {
  WalkWorld::Options options;
  options.points_per_m3 = 22;
  WalkWorld world(options);
  SlamConfig config = test_support::settled();
  config.loop.confirmations = 3;
  config.keyframe.min_gap_s = 0;  // many keyframes on the lap, few of them where it closes
  SlamSystem slam(config, MappingMode::kSynchronous, test_support::frozen_clock);
  MapChanges changes;
  bool closed = false;
  for (int i = 0; i < 230 && !closed; ++i) {
    const auto message = world.view(static_cast<std::uint64_t>(i), pose_on_circle(i));
    message->intrinsics[0] *= 1.02;
    message->intrinsics[1] *= 1.02;
    closed = !slam.process(*message).loops.empty();
    if (!closed) changes.update(slam.map_view());
  }
  ASSERT_TRUE(closed);
  const MapView view = slam.map_view();
  const MapNews news = changes.update(view);
  const auto with_points = std::ranges::count_if(news.keyframes, &KeyframeNews::points);
  const std::size_t loop_bytes = bytes_of(make_map_updates(view, news));
  const MapNews everything = changes.update(view, MapChanges::Extent::kEverything);
  const std::size_t all_bytes = bytes_of(make_map_updates(view, everything));
  std::printf("%zu keyframes, %zu moved, %ld of them with points: %zu B; the whole map %zu B\n", view.keyframes.size(),
              news.keyframes.size(), with_points, loop_bytes, all_bytes);
  EXPECT_TRUE(news.loops);
  EXPECT_GT(news.keyframes.size(), view.keyframes.size() / 2) << "the loop moved most of the map";
  EXPECT_LT(with_points, static_cast<long>(news.keyframes.size()) / 4) << "only the place itself got other landmarks";
  EXPECT_LT(loop_bytes, all_bytes / 3);
}

/// rtd/keyframe_request and rtd/keyframe_features as an atlas uses them.

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
