// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// An atlas that dies, and a robot that is out of reach, on the in-process bus: robots go on, the maps meet again.
#include <gmock/gmock.h>

#include <filesystem>
#include <future>

#include "common/bus/bus_factory.hpp"
#include "services/atlas/atlas_service.hpp"
#include "tests/support/atlas_bus_robot.hpp"
#include "tests/support/inprocess/inprocess_bus.hpp"

namespace rtd::atlas {
namespace {

using namespace std::chrono_literals;
using test_support::AtlasBusRobot;
using test_support::FeatureWorld;
using test_support::Inbox;

constexpr std::chrono::milliseconds kSoon = 10s;  ///< until maps meet again

std::shared_ptr<bus::Bus> connect(std::uint32_t domain) {
  bus::BusOptions options;
  options.vendor = bus::inprocess::vendor();
  options.domain = domain;
  return bus::connect(options);
}

/// An atlas that can end and start again.
class AtlasProcess {
 public:
  AtlasProcess(bus::Bus& bus, ServiceConfig config) : bus_(bus), config_(std::move(config)) { start(); }
  ~AtlasProcess() { end(); }

  void start() {
    stop_.emplace();
    running_ = std::async(std::launch::async, [this] {
      service::Heartbeat heartbeat(bus_, AtlasService::kName, *stop_);
      service::Runtime runtime{bus_, heartbeat, *stop_, service::Pace::kRealtime, {}};
      return AtlasService(config_, runtime).run();
    });
  }
  void end() {
    stop_->request_stop();
    if (running_.valid()) running_.get();
  }
  /// What it would have saved at its end is lost: the file is that of the last checkpoint.
  void kill() {
    const std::filesystem::path file = config_.map_file, kept = config_.map_file + ".kept";
    constexpr auto kReplace = std::filesystem::copy_options::overwrite_existing;
    const bool saved = std::filesystem::exists(file);
    if (saved) std::filesystem::copy_file(file, kept, kReplace);
    end();
    std::filesystem::remove(file);
    if (saved) std::filesystem::rename(kept, file);
  }

 private:
  bus::Bus& bus_;
  const ServiceConfig config_;
  std::optional<service::StopToken> stop_;
  std::future<service::ExitCode> running_;
};

/// Carries the topics of one robot between its bus and that of the atlas.
class Link {
 public:
  Link(const bus::Bus& robot_side, const bus::Bus& atlas_side, const std::string& robot)
      : robot_side_(robot_side.of_robot(robot)), atlas_side_(atlas_side.of_robot(robot)) {
    connect();
  }
  void connect() {
    carry(*robot_side_, *atlas_side_, bus::topics::kMap);
    carry(*robot_side_, *atlas_side_, bus::topics::kKeyframeFeatures);
    carry(*atlas_side_, *robot_side_, bus::topics::kKeyframeRequest);
    carry(*atlas_side_, *robot_side_, bus::topics::kSubmap);
  }
  /// Messages are lost, and both sides find that the other is gone.
  void cut() { carriers_.clear(); }

 private:
  template <class T>
  void carry(bus::Bus& from, bus::Bus& to, const bus::Topic<T>& topic) {
    const auto writer = std::make_shared<bus::Writer<T>>(to.writer(topic));
    carriers_.push_back(std::make_shared<bus::Reader<T>>(
        from.reader(topic, [writer](std::shared_ptr<const T> message) { writer->write(*message); })));
  }

  const std::shared_ptr<bus::Bus> robot_side_, atlas_side_;
  std::vector<std::shared_ptr<void>> carriers_;
};

class AtlasOutageTest : public testing::Test {
 protected:
  AtlasOutageTest() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    config_.robots = {"anna", "bert"};
    config_.map_file = (folder_ / "building.rtdmap").string();
    config_.checkpoint_s = 1;
    reader_ = bus_->reader<msg::AtlasState>(
        bus::topics::kAtlas,
        [inbox = states_](std::shared_ptr<const msg::AtlasState> state) { inbox.take(std::move(state)); });
  }
  ~AtlasOutageTest() override { std::filesystem::remove_all(folder_); }

  /// Whether a state that comes from now on has both in one map, with nothing missing.
  bool meet() {
    const std::size_t before = states_.all().size();
    return states_.wait(
        [&](const auto& all) {
          return all.size() > before + 1 && all.back()->robots.size() == 2 &&
                 std::ranges::all_of(all.back()->robots, [](const msg::AtlasRobot& robot) {
                   return robot.met && robot.missing == 0 && robot.keyframes > 0;
                 });
        },
        kSoon);
  }
  std::uint32_t keyframes_of_bert() { return test_support::robot_in(*states_.all().back(), "bert").keyframes; }

  /// What the robot would have found alone.
  void expect_poses_as_alone(const AtlasBusRobot& robot, std::uint64_t first_seq) {
    slam::SlamSystem alone{test_support::settled(), slam::MappingMode::kSynchronous, test_support::frozen_clock};
    for (std::size_t i = 0; i < robot.poses.size(); ++i)
      ASSERT_EQ(alone.process(*world_.view(first_seq + i)).result.T_world_camera.matrix(), robot.poses[i].matrix())
          << i;
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() /
      (std::string("rtd_atlas_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  const FeatureWorld world_ = FeatureWorld::noisy();
  ServiceConfig config_;
  Inbox<msg::AtlasState> states_;
  const std::shared_ptr<bus::Bus> bus_ = connect(90);
  bus::Reader<msg::AtlasState> reader_;
};

TEST_F(AtlasOutageTest, a_robot_that_was_out_of_reach_sends_what_it_mapped_meanwhile) {
  AtlasProcess atlas(*bus_, config_);
  const auto far_bus = connect(91);
  Link link(*far_bus, *bus_, "bert");
  AtlasBusRobot anna(*bus_, "anna", world_, 0), bert(*far_bus, "bert", world_, 250);
  anna.walk(400);
  bert.walk(400);
  ASSERT_TRUE(meet());
  const std::uint32_t before = keyframes_of_bert();
  link.cut();
  bert.walk(300);
  std::this_thread::sleep_for(1s);  // what was on its way has come
  EXPECT_EQ(keyframes_of_bert(), before);
  link.connect();
  const bool caught_up = states_.wait(
      [&](const auto& all) {
        const msg::AtlasRobot& robot = test_support::robot_in(*all.back(), "bert");
        return robot.met && robot.missing == 0 && robot.keyframes > before;
      },
      kSoon);
  EXPECT_TRUE(caught_up);
  expect_poses_as_alone(bert, 250);
}

TEST_F(AtlasOutageTest, robots_go_on_while_the_atlas_is_killed_and_meet_again) {
  AtlasProcess atlas(*bus_, config_);
  AtlasBusRobot anna(*bus_, "anna", world_, 0), bert(*bus_, "bert", world_, 250);
  // So long that the maps meet whichever comes first: three of the keyframes that come later must say so.
  anna.walk(400);
  bert.walk(400);
  ASSERT_TRUE(meet());
  for (int death = 0; death < 3; ++death) {
    atlas.kill();
    anna.walk(50);
    bert.walk(50);
    atlas.start();
    EXPECT_TRUE(meet()) << "after death " << death;
  }
  expect_poses_as_alone(anna, 0);
  expect_poses_as_alone(bert, 250);
}

}  // namespace
}  // namespace rtd::atlas
