// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// An atlas and the robots that talk to it, on the in-process bus.
#include "services/atlas/atlas_service.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "common/msg/transform_eigen.hpp"
#include "services/atlas/status_command.hpp"
#include "services/slam/map_file.hpp"
#include "tests/support/atlas_bus_robot.hpp"
#include "tests/support/service_fixture.hpp"

namespace rtd::atlas {
namespace {

using test_support::AtlasBusRobot;
using test_support::FeatureWorld;
using test_support::Inbox;

Eigen::Isometry3d to_isometry(const msg::RosTransform& transform) {
  const auto& [translation, rotation] = transform;
  return msg::to_isometry(
      {{translation.x, translation.y, translation.z}, {rotation.x, rotation.y, rotation.z, rotation.w}});
}

class AtlasServiceTest : public test_support::ServiceFixture<AtlasService> {
 protected:
  AtlasServiceTest() {
    config_.robots = {"anna", "bert"};
    config_.map_file = (folder_ / "building.rtdmap").string();
    std::filesystem::create_directories(folder_);
    state_reader_ = bus_->reader<msg::AtlasState>(
        bus::topics::kAtlas,
        [inbox = atlas_](std::shared_ptr<const msg::AtlasState> state) { inbox.take(std::move(state)); });
    tf_reader_ = bus_->reader<msg::TFMessage>(
        bus::topics::kTfStatic,
        [inbox = transforms_](std::shared_ptr<const msg::TFMessage> tf) { inbox.take(std::move(tf)); });
  }
  /// Both walk through one room until the atlas has them in one map.
  void let_them_meet() {
    start(service::Pace::kRealtime);
    anna_.emplace(*bus_, "anna", world_, 0);
    anna_->walk(200);
    // Those of bert are found at places that are there: hers are too few to be found at his.
    ASSERT_TRUE(atlas_.wait([](const auto& all) {
      return !all.empty() && !all.back()->robots.empty() && all.back()->robots[0].keyframes > 0 &&
             all.back()->robots[0].missing == 0;
    }));
    bert_.emplace(*bus_, "bert", world_, 250);
    bert_->walk(200);
    ASSERT_TRUE(atlas_.wait([](const auto& all) {
      return !all.empty() && all.back()->robots.size() == 2 &&
             std::ranges::all_of(all.back()->robots, &msg::AtlasRobot::met);
    }));
  }
  bus::CommandAnswer call(const std::string& command, const std::string& argument) {
    return bus_->commands()->call(command, {argument}).value_or(bus::CommandAnswer{false, "not offered"});
  }

  const FeatureWorld world_ = FeatureWorld::noisy();
  Inbox<msg::AtlasState> atlas_;
  Inbox<msg::TFMessage> transforms_;
  bus::Reader<msg::AtlasState> state_reader_;
  bus::Reader<msg::TFMessage> tf_reader_;
  std::optional<AtlasBusRobot> anna_, bert_;
};

TEST_F(AtlasServiceTest, puts_robots_of_one_room_into_one_map) {
  let_them_meet();
  ASSERT_TRUE(transforms_.wait([](const auto& all) { return !all.empty() && all.back()->transforms.size() == 2; }));
  const auto tf = transforms_.all().back();
  const auto T_map = [&](std::size_t robot) { return to_isometry(tf->transforms[robot].transform); };
  EXPECT_EQ(tf->transforms[0].header.frame_id, "map");
  EXPECT_EQ(tf->transforms[0].child_frame_id, "anna/map");
  EXPECT_EQ(tf->transforms[1].child_frame_id, "bert/map");
  const Eigen::Isometry3d T_anna_bert = T_map(0).inverse() * T_map(1);
  EXPECT_LT((T_anna_bert.inverse() * FeatureWorld::T_world_camera(250)).translation().norm(), 0.02)
      << "bert's map began there";
  EXPECT_THAT(to_table(*atlas_.all().back()), testing::HasSubstr("bert"));
}

TEST_F(AtlasServiceTest, says_when_the_map_of_a_robot_has_jumped) {
  Inbox<msg::TransformStamped> jumps;
  receive(bus::topics::kAtlasMapJumps, jumps);
  let_them_meet();
  ASSERT_TRUE(transforms_.wait([](const auto& all) { return !all.empty() && all.back()->transforms.size() == 2; }));
  const auto T_map_bert = [](const auto& all) { return to_isometry(all.back()->transforms[1].transform); };
  const Eigen::Isometry3d before = T_map_bert(transforms_.all());
  const std::size_t known = jumps.all().size();
  bert_->move_map(0.5);
  ASSERT_TRUE(jumps.wait([&](const auto& all) { return all.size() > known; }));
  const msg::TransformStamped jump = *jumps.all().back();
  EXPECT_EQ(jump.header.frame_id, "map");
  EXPECT_EQ(jump.child_frame_id, "bert/map");
  ASSERT_TRUE(transforms_.wait(
      [&](const auto& all) { return (T_map_bert(all).translation() - before.translation()).norm() > 0.4; }));
  EXPECT_LT((T_map_bert(transforms_.all()).inverse() * to_isometry(jump.transform) * before).translation().norm(),
            0.01);
}

TEST_F(AtlasServiceTest, joins_the_floor_plans_of_robots_that_have_met) {
  Inbox<msg::OccupancyGrid> joint;
  receive(bus::topics::kAtlasFloorPlan, joint);
  let_them_meet();
  std::vector<std::shared_ptr<bus::Bus>> buses;
  std::vector<bus::Writer<msg::OccupancyGrid>> dense;
  for (const char* robot : {"anna", "bert"}) {
    dense.push_back(buses.emplace_back(bus_->of_robot(robot))->writer(bus::topics::kOccupancyGrid));
    msg::OccupancyGrid plan;
    plan.info.resolution = 0.1F;
    plan.info.width = plan.info.height = 10;
    plan.info.origin = {{buses.size() * 20.0, 0, 0}, {0, 0, 0, 1}};
    plan.data.assign(100, 0);
    dense.back().write(plan);
  }
  const auto known = [](const auto& all) {
    return all.empty() ? 0 : std::ranges::count(all.back()->data, std::int8_t{0});
  };
  ASSERT_TRUE(joint.wait([&](const auto& all) { return known(all) > 150; })) << "of both";
  EXPECT_TRUE(call("atlas/forget", "anna").success);
  ASSERT_TRUE(joint.wait([&](const auto& all) { return known(all) < 150; })) << "of one";
  EXPECT_GT(known(joint.all()), 50);
}

TEST_F(AtlasServiceTest, answers_a_robot_that_asks_where_it_is) {
  let_them_meet();
  bert_->ask_where();
  ASSERT_TRUE(bert_->submaps.wait_count(1));
  EXPECT_GE(test_support::map_of(*bert_->submaps.all().back()).keyframes.size(), 3U);
  EXPECT_TRUE(anna_->submaps.all().empty()) << "no other robot";
}

TEST_F(AtlasServiceTest, saves_the_map_and_forgets_a_robot) {
  let_them_meet();
  const bus::CommandAnswer saved = call("atlas/save", "");
  EXPECT_TRUE(saved.success) << saved.message;
  const std::size_t both = slam::load_map_file(config_.map_file).keyframes.size();
  EXPECT_FALSE(call("atlas/forget", "carl").success);
  const bus::CommandAnswer forgotten = call("atlas/forget", "anna");
  EXPECT_TRUE(forgotten.success) << forgotten.message;
  ASSERT_TRUE(atlas_.wait([](const auto& all) { return all.back()->robots.size() == 1; }));
  EXPECT_EQ(stop(), service::kOk);
  const std::size_t without = slam::load_map_file(config_.map_file).keyframes.size();
  EXPECT_LT(without, both);
  EXPECT_GT(without, 0U);
}

TEST_F(AtlasServiceTest, a_map_whose_robots_are_all_forgotten_has_no_file) {
  let_them_meet();
  EXPECT_TRUE(call("atlas/save", "").success);
  for (const char* robot : {"anna", "bert"}) EXPECT_TRUE(call("atlas/forget", robot).success);
  EXPECT_EQ(stop(), service::kOk);
  EXPECT_TRUE(std::filesystem::is_empty(folder_)) << "also whose keyframes they were";
}

TEST_F(AtlasServiceTest, continues_with_the_map_that_it_saved) {
  let_them_meet();
  EXPECT_TRUE(call("atlas/save", "").success);
  const bus::CommandAnswer loaded = call("atlas/load", "");
  EXPECT_TRUE(loaded.success) << loaded.message;
  ASSERT_TRUE(atlas_.wait([](const auto& all) {
    const auto& robots = all.back()->robots;
    return robots.size() == 2 && std::ranges::all_of(robots, &msg::AtlasRobot::met) && robots[1].meetings == 0;
  })) << "their keyframes are recognised, without another meeting";
  EXPECT_EQ(atlas_.all().back()->robots[0].missing, 0U);
}

TEST_F(AtlasServiceTest, a_map_that_is_none_ends_the_start_with_its_cause) {
  std::ofstream(config_.map_file) << "no map";
  launch(service::Pace::kRealtime);
  EXPECT_THAT([this] { running_code(); }, testing::ThrowsMessage<service::ConfigError>(testing::AllOf(
                                              testing::HasSubstr("atlas.map"), testing::HasSubstr("not a map file"))));
}

}  // namespace
}  // namespace rtd::atlas
