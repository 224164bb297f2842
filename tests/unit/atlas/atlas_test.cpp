// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/atlas/core/atlas.hpp"

#include <gmock/gmock.h>

#include "common/geometry/se3.hpp"
#include "services/atlas/core/submap.hpp"
#include "services/slam/core/store/map_store.hpp"
#include "tests/support/atlas_robot.hpp"

namespace rtd::atlas {
namespace {

using test_support::AtlasRobot;
using test_support::FeatureWorld;
using test_support::map_of;
using test_support::query_of;
using test_support::robot_in;

/// Where the atlas has a robot in the frame of the first one, m from where it is.
double error_m(const Atlas& atlas, const AtlasRobot& first, const AtlasRobot& robot) {
  const msg::AtlasState state = atlas.state();
  const msg::AtlasRobot& entry = robot_in(state, robot.name());
  if (!entry.met) return 1e9;
  const Eigen::Isometry3d truth = first.T_world_map().inverse() * robot.T_world_camera(entry.stamp_ns);
  return (msg::to_isometry(entry.T_map_camera).inverse() * truth).translation().norm();
}

TEST(Atlas, robots_in_one_room_meet) {
  const FeatureWorld world = FeatureWorld::noisy();
  Atlas atlas({});
  AtlasRobot anna("anna", world, 0), bert("bert", world, 250);
  anna.walk(150, atlas);
  EXPECT_TRUE(robot_in(atlas.state(), "anna").met) << "the first one makes the frame";
  bert.walk(150, atlas);
  const msg::AtlasState state = atlas.state();
  EXPECT_TRUE(robot_in(state, "bert").met);
  EXPECT_GE(robot_in(state, "bert").meetings, 1U);
  EXPECT_LT(error_m(atlas, anna, bert), 0.01);
  EXPECT_EQ(atlas.map().check_invariants(), "");
}

TEST(Atlas, robots_in_other_rooms_do_not) {
  const FeatureWorld world = FeatureWorld::noisy(1), other = FeatureWorld::noisy(2);
  Atlas atlas({});
  AtlasRobot anna("anna", world, 0), bert("bert", other, 250);
  anna.walk(150, atlas);
  bert.walk(150, atlas);
  EXPECT_FALSE(robot_in(atlas.state(), "bert").met);
  EXPECT_EQ(atlas.counters().meetings, 0U);
}

TEST(Atlas, robots_that_share_a_clock_share_nothing_else) {
  const FeatureWorld world = FeatureWorld::noisy(1), other = FeatureWorld::noisy(2);
  Atlas atlas({});
  AtlasRobot anna("anna", world, 0), bert("bert", other, 0);
  for (int i = 0; i < 10; ++i) {
    anna.walk(45, atlas);
    bert.walk(45, atlas);
  }
  EXPECT_FALSE(robot_in(atlas.state(), "bert").met) << "equal stamps and numbers, as in a simulation";
  EXPECT_GT(robot_in(atlas.state(), "bert").keyframes, 1U);
}

TEST(Atlas, a_robot_that_starts_anywhere_gets_the_map_around_it) {
  const FeatureWorld world = FeatureWorld::noisy();
  Atlas atlas({});
  AtlasRobot anna("anna", world, 0), bert("bert", world, 300);
  anna.walk(300, atlas);
  for (const std::uint64_t seq : {310U, 333U, 371U, 402U}) {
    const auto submap = atlas.locate(query_of(*world.view(seq)));
    ASSERT_TRUE(submap) << seq;
    const Eigen::Isometry3d truth = anna.T_world_map().inverse() * FeatureWorld::T_world_camera(seq);
    EXPECT_LT((msg::to_isometry(submap->T_map_camera).inverse() * truth).translation().norm(), 0.02) << seq;
  }
  bert.slam().load_map(map_of(*atlas.locate(query_of(*world.view(300)))));
  bert.walk(90, atlas);
  EXPECT_LT(error_m(atlas, anna, bert), 0.02);
  EXPECT_EQ(atlas.counters().meetings, 0U) << "it is in the joint map without one";
  EXPECT_FALSE(atlas.locate(query_of(*FeatureWorld::noisy(2).view(10)))) << "another room";
}

TEST(Atlas, a_robot_can_be_taken_out_with_all_it_brought) {
  const FeatureWorld world = FeatureWorld::noisy();
  Atlas atlas({});
  AtlasRobot anna("anna", world, 0), bert("bert", world, 250), carl("carl", world, 120);
  for (AtlasRobot* robot : {&anna, &bert, &carl}) robot->walk(250, atlas);
  const std::uint32_t others = robot_in(atlas.state(), "bert").keyframes + robot_in(atlas.state(), "carl").keyframes;
  EXPECT_GT(atlas.forget("anna"), 0U) << "also the one that made the frame";
  EXPECT_EQ(atlas.map().keyframes().size(), others);
  EXPECT_EQ(atlas.map().check_invariants(), "");
  EXPECT_LT(error_m(atlas, anna, bert), 0.01) << "the frame stays";
  EXPECT_LT(error_m(atlas, anna, carl), 0.01);
  EXPECT_EQ(atlas.forget("dora"), 0U);
}

TEST(Atlas, the_frame_is_that_of_the_oldest_world_that_is_left) {
  const FeatureWorld world = FeatureWorld::noisy(1), other = FeatureWorld::noisy(2);
  Atlas atlas({});
  AtlasRobot anna("anna", world, 0), bert("bert", other, 250);
  anna.walk(150, atlas);
  bert.walk(150, atlas);
  ASSERT_FALSE(robot_in(atlas.state(), "bert").met);
  msg::MapUpdate removal;  // by anna itself, of all that it had
  removal.session_ns = anna.teller().session_ns;
  for (const slam::KeyframeView& keyframe : anna.slam().map_view().keyframes) {
    removal.keyframes.emplace_back().keyframe_id = keyframe.id;
    removal.keyframes.back().content = msg::kMapRemoved;
  }
  atlas.follow("anna", removal, 0);
  EXPECT_TRUE(robot_in(atlas.state(), "bert").met);
  EXPECT_FALSE(atlas.contents().keyframes.empty());
}

TEST(Atlas, a_map_that_was_saved_continues_with_the_same_robots) {
  const FeatureWorld world = FeatureWorld::noisy();
  Atlas before({});
  AtlasRobot anna("anna", world, 0), bert("bert", world, 250);
  anna.walk(150, before);
  bert.walk(150, before);
  const io::Bytes file = to_map_file(before.contents());
  Atlas after({});
  after.restore(slam::read_map(io::MemorySource(file)), before.owners());
  EXPECT_EQ(to_map_file(after.contents()), file);
  anna.teller().forget_reported();
  anna.teller().report(after);
  EXPECT_EQ(after.counters().keyframes, 0U) << "what is in the map is not asked for again";
  anna.walk(200, after);
  EXPECT_GT(after.counters().keyframes, 0U);
  EXPECT_LT(error_m(after, anna, anna), 0.01);
}

TEST(Atlas, old_keyframes_of_a_place_give_way_to_newer_ones) {
  const FeatureWorld world = FeatureWorld::noisy();
  AtlasConfig config;
  config.cell_keyframes = 1;
  Atlas atlas(config);
  AtlasRobot anna("anna", world, 0);
  anna.walk(600, atlas);
  const std::size_t kept = atlas.map().keyframes().size();
  EXPECT_GT(atlas.counters().given_way, 0U);
  anna.walk(600, atlas);
  EXPECT_LE(atlas.map().keyframes().size(), kept + kept / 4) << "the same room takes no more, however long";
  EXPECT_TRUE(atlas.missing("anna", 100).keyframe_ids.empty()) << "what gave way is not asked for again";
  EXPECT_EQ(atlas.map().check_invariants(), "");
}

TEST(Atlas, a_robot_stays_where_others_come_by_for_long) {
  const FeatureWorld world = FeatureWorld::noisy();
  AtlasConfig config;
  config.cell_keyframes = 1;
  config.look_every = 1000;  // meetings are not what this is about
  Atlas atlas(config);
  AtlasRobot anna("anna", world, 0), bert("bert", world, 0);
  anna.walk(600, atlas);
  bert.walk(150, atlas);
  ASSERT_TRUE(robot_in(atlas.state(), "bert").met);
  bert.walk(900, atlas);
  EXPECT_GT(atlas.counters().given_way, 0U);
  EXPECT_EQ(robot_in(atlas.state(), "anna").keyframes, 3U) << "all others are older than what bert has seen there";
  EXPECT_TRUE(robot_in(atlas.state(), "anna").met);
}

TEST(Atlas, keyframes_of_a_robot_whose_clock_is_days_ahead_give_way_too) {
  constexpr std::int64_t kDaysNs = 3LL * 24 * 3600 * 1'000'000'000;
  const FeatureWorld world = FeatureWorld::noisy();
  AtlasConfig config;
  config.cell_keyframes = 1;
  config.settled_after = 0;
  Atlas atlas(config), restarted(config);
  AtlasRobot ahead("ahead", world, 0), later("later", world, 600);
  ahead.teller().clock_behind_ns = -kDaysNs;
  ahead.walk(300, atlas);
  restarted.restore(atlas.contents(), atlas.owners());
  ahead.teller().forget_reported();
  ahead.teller().report(restarted);
  const std::uint32_t alone = robot_in(atlas.state(), "ahead").keyframes;
  ASSERT_EQ(robot_in(restarted.state(), "ahead").keyframes, alone);
  later.walk(600, atlas);
  later.teller().forget_reported();
  later.walk(400, restarted);
  EXPECT_LT(robot_in(atlas.state(), "ahead").keyframes, alone);
  EXPECT_LT(robot_in(restarted.state(), "ahead").keyframes, alone) << "also those that were restored";
}

TEST(Atlas, what_is_beyond_the_most_keyframes_is_not_asked_for_again) {
  const FeatureWorld world = FeatureWorld::noisy();
  AtlasConfig config;
  config.most_keyframes = 5;
  config.settled_after = 0;
  Atlas atlas(config);
  AtlasRobot anna("anna", world, 0);
  anna.walk(300, atlas);
  EXPECT_EQ(atlas.map().keyframes().size(), 5U);
  EXPECT_TRUE(atlas.missing("anna", 100).keyframe_ids.empty()) << "or the oldest would come and go for ever";
  EXPECT_EQ(robot_in(atlas.state(), "anna").missing, 0U);
}

TEST(Atlas, what_gave_way_to_a_robot_that_is_forgotten_is_wanted_again) {
  const FeatureWorld world = FeatureWorld::noisy();
  AtlasConfig config;
  config.cell_keyframes = 1;
  config.settled_after = 0;
  Atlas atlas(config);
  AtlasRobot anna("anna", world, 0), bert("bert", world, 600);
  anna.walk(300, atlas);
  const std::uint32_t alone = robot_in(atlas.state(), "anna").keyframes;
  bert.walk(600, atlas);
  ASSERT_LT(robot_in(atlas.state(), "anna").keyframes, alone) << "the rest gave way to newer ones of bert";
  atlas.forget("bert");
  anna.teller().report(atlas);
  EXPECT_GE(robot_in(atlas.state(), "anna").keyframes, alone);
}

TEST(Atlas, a_robot_with_a_false_map_bends_no_other_map) {
  const FeatureWorld world = FeatureWorld::noisy();
  Atlas atlas({});
  AtlasRobot anna("anna", world, 0), bert("bert", world, 250);
  anna.walk(200, atlas);
  bert.walk(200, atlas);
  const Eigen::Isometry3d before = atlas.map().keyframes().begin()->second.T_world_camera;
  // From now on bert says that its keyframes lie elsewhere, each somewhere else.
  msg::MapUpdate lies;
  lies.session_ns = bert.teller().session_ns;
  for (const slam::KeyframeView& keyframe : bert.slam().map_view().keyframes) {
    msg::MapKeyframe& entry = lies.keyframes.emplace_back();
    entry.keyframe_id = keyframe.id;
    entry.stamp_ns = keyframe.stamp_ns;
    Eigen::Isometry3d T = keyframe.T_world_camera;
    T.translation() *= 1.0 + keyframe.id;
    entry.T_world_camera = msg::to_message(T);
  }
  atlas.follow("bert", lies, lies.keyframes.back().stamp_ns);
  atlas.straighten();
  EXPECT_LT((atlas.map().keyframes().begin()->second.T_world_camera.inverse() * before).translation().norm(), 1e-6);
  EXPECT_LT(error_m(atlas, anna, anna), 0.01);
}

/// Keyframes of a robot as it sends them, with where it has them.
struct SentKeyframe {
  Eigen::Isometry3d T_robot_camera;
  msg::KeyframeFeatures features;
};

std::vector<SentKeyframe> keyframes_of(AtlasRobot& robot) {
  return robot.slam().read_map([](const slam::Map& map) {
    std::vector<SentKeyframe> sent;
    for (const auto& [id, keyframe] : map.keyframes())
      sent.push_back({keyframe.T_world_camera, slam::make_features(map, keyframe, true)});
    return sent;
  });
}

/// Sends them as the next ones of `name`, each `T` from where it was.
class Sender {
 public:
  explicit Sender(std::string name) : name_(std::move(name)) {}
  void send(Atlas& atlas, const std::vector<SentKeyframe>& keyframes, const Eigen::Isometry3d& T) {
    for (const SentKeyframe& keyframe : keyframes) {
      msg::KeyframeFeatures features = keyframe.features;
      features.session_ns = 1;
      features.keyframe_id = next_++;
      features.stamp_ns += 1'000'000'000LL * next_;
      for (msg::KeyframeFeature& feature : features.features)
        if (feature.landmark_id != msg::kNoId) feature.landmark_id += 100'000U * next_;
      msg::MapUpdate update;
      update.session_ns = 1;
      msg::MapKeyframe& entry = update.keyframes.emplace_back();
      entry.keyframe_id = features.keyframe_id;
      entry.stamp_ns = features.stamp_ns;
      entry.T_world_camera = msg::to_message(T * keyframe.T_robot_camera);
      atlas.follow(name_, update, entry.stamp_ns);
      atlas.add(name_, features);
      atlas.straighten();
    }
  }

 private:
  std::string name_;
  std::uint32_t next_ = 0;
};

TEST(Atlas, a_place_that_is_there_twice_joins_no_robots) {
  const FeatureWorld world = FeatureWorld::noisy();
  Atlas atlas({});
  AtlasRobot anna("anna", world, 0);
  anna.walk(200, atlas);
  const std::vector<SentKeyframe> room = keyframes_of(anna);
  Sender bert("bert");
  bert.send(atlas, room, Eigen::Isometry3d::Identity());
  ASSERT_TRUE(robot_in(atlas.state(), "bert").met) << "so far nothing speaks against it";
  EXPECT_TRUE(atlas.locate(query_of(*world.view(50))));
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation().x() = 30;
  bert.send(atlas, room, T);
  EXPECT_FALSE(robot_in(atlas.state(), "bert").met) << "the room is there twice: in which of them is anna?";
  EXPECT_GE(atlas.counters().refused, 1U);
  bert.send(atlas, room, T);
  EXPECT_FALSE(robot_in(atlas.state(), "bert").met);
  EXPECT_TRUE(robot_in(atlas.state(), "anna").met);
  EXPECT_EQ(atlas.map().check_invariants(), "");
}

TEST(Atlas, says_nothing_where_a_view_fits_two_places) {
  const FeatureWorld world = FeatureWorld::noisy();
  Atlas atlas({});
  AtlasRobot anna("anna", world, 0);
  anna.walk(200, atlas);
  const std::vector<SentKeyframe> room = keyframes_of(anna);
  Atlas doubled({});
  Sender carl("carl");
  carl.send(doubled, room, Eigen::Isometry3d::Identity());
  EXPECT_TRUE(doubled.locate(query_of(*world.view(50))));
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation().x() = 30;
  carl.send(doubled, room, T);
  EXPECT_FALSE(doubled.locate(query_of(*world.view(50))));
}

TEST(Atlas, says_nothing_where_a_view_does_not_say_from_where) {
  const FeatureWorld world = FeatureWorld::noisy();
  AtlasConfig strict;
  strict.place_sigma_m = 1e-4;
  Atlas atlas({}), strict_atlas(strict);
  AtlasRobot anna("anna", world, 0), bert("bert", world, 0);
  anna.walk(150, atlas);
  bert.walk(150, strict_atlas);
  EXPECT_TRUE(atlas.locate(query_of(*world.view(100))));
  EXPECT_FALSE(strict_atlas.locate(query_of(*world.view(100)))) << "not known to a tenth of a millimetre";
}

TEST(Atlas, one_wall_alike_in_rooms_that_differ_joins_no_robots) {
  const FeatureWorld world = FeatureWorld::noisy(1), other = FeatureWorld::noisy(2);
  Atlas atlas({}), of_dora({});
  AtlasRobot anna("anna", world, 0), dora("dora", other, 0);
  anna.walk(200, atlas);
  dora.walk(500, of_dora);
  const std::vector<SentKeyframe> room = keyframes_of(anna), other_room = keyframes_of(dora);
  ASSERT_GE(room.size(), 4U);
  ASSERT_GE(other_room.size(), 5U);
  Sender bert("bert");
  bert.send(atlas, other_room, Eigen::Isometry3d::Identity());
  bert.send(atlas, {room.begin(), room.begin() + 4}, Eigen::Isometry3d::Identity());
  EXPECT_GE(atlas.counters().met, 3U) << "the wall is found";
  EXPECT_EQ(atlas.counters().meetings, 0U) << "where both have looked, nothing else is";
}

TEST(Atlas, knows_that_it_changed) {
  const FeatureWorld world = FeatureWorld::noisy();
  Atlas atlas({});
  AtlasRobot anna("anna", world, 0);
  anna.walk(150, atlas);
  const std::uint64_t before = atlas.revision();
  EXPECT_GT(before, 0U);
  anna.teller().report(atlas);
  EXPECT_EQ(atlas.revision(), before) << "nothing new";
  atlas.forget("anna");
  EXPECT_GT(atlas.revision(), before) << "or a checkpoint would keep what was forgotten";
}

TEST(Atlas, takes_nothing_that_cannot_be) {
  const FeatureWorld world = FeatureWorld::noisy();
  Atlas atlas({});
  AtlasRobot anna("anna", world, 0);
  anna.walk(60, atlas);
  msg::KeyframeFeatures features = query_of(*world.view(90));
  EXPECT_FALSE(atlas.add("anna", features)) << "never announced";
  EXPECT_FALSE(atlas.add("carl", features));
  features.width = 0;
  EXPECT_FALSE(atlas.locate(features));
  features = query_of(*world.view(90));
  for (msg::KeyframeFeature& feature : features.features) feature.octave = 31;
  EXPECT_FALSE(atlas.locate(features));
  features.features.clear();
  EXPECT_FALSE(atlas.locate(features));
}

}  // namespace
}  // namespace rtd::atlas
