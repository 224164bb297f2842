// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// The map of one service is the map of the next.
#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/bus/commands.hpp"
#include "common/io/input_file.hpp"
#include "common/io/text.hpp"
#include "common/msg/transform_eigen.hpp"
#include "common/service/config.hpp"
#include "services/slam/map_file.hpp"
#include "services/slam/slam_service.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/service_fixture.hpp"
#include "tests/support/settled_map.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::slam {
namespace {

using test_support::FeatureWorld;
using test_support::Inbox;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class MapServiceTest : public test_support::ServiceFixture<SlamService> {
 protected:
  MapServiceTest() : features_(bus_->writer(bus::topics::kFeatures)), file_((folder_ / "room.rtdmap").string()) {
    receive(bus::topics::kTracking, results_);
    config_.core = test_support::settled();
    std::filesystem::create_directories(folder_);
  }

  void step(std::uint64_t seq) {
    const std::size_t before = results_.all().size();
    ASSERT_TRUE(features_.write(*world_.view(seq, FeatureWorld::T_world_camera(seq))));
    ASSERT_TRUE(results_.wait_count(before + 1)) << "no result for frame " << seq;
  }
  std::string call(const char* command, const std::string& argument = {}) {
    if (!client_) client_.emplace(bus_options_);
    const bus::CommandAnswer answer = client_->call(command, argument, 20'000);
    return (answer.success ? "" : "failed: ") + answer.message;
  }
  /// A map of 60 frames in file_, made by a core alone.
  void make_map() const {
    SlamSystem slam(test_support::settled(), MappingMode::kSynchronous, [] { return 0; });
    for (std::uint64_t seq = 0; seq < 60; ++seq) slam.process(*world_.view(seq, FeatureWorld::T_world_camera(seq)));
    slam.read_map([&](const Map& map) { save_map_file(file_, take_snapshot(map)); });
  }
  std::string bytes() const {
    std::ifstream file(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  /// Waits until the file is there and holds at least so many keyframes.
  bool wait_saved(std::size_t keyframes) const {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (std::chrono::steady_clock::now() < give_up) {
      if (std::filesystem::exists(file_) && load_map_file(file_).keyframes.size() >= keyframes) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }

  const FeatureWorld world_{{}};
  Inbox<msg::TrackingResult> results_;
  std::optional<bus::CommandClient> client_;
  bus::Writer<msg::FeatureFrame> features_;
  const std::string file_;
};

TEST_F(MapServiceTest, saves_its_map_at_the_end) {
  config_.map.save = file_;
  config_.map.checkpoint_s = 0;
  start(service::Pace::kLockstep);
  for (std::uint64_t seq = 0; seq < 40; ++seq) step(seq);
  EXPECT_FALSE(std::filesystem::exists(file_));
  EXPECT_EQ(stop(), service::kOk);
  EXPECT_EQ(load_map_file(file_).keyframes.size(), results_.all().back()->keyframes);
}

TEST_F(MapServiceTest, obeys_commands_between_frames_and_answers_every_frame) {
  config_.map.folder = folder_;
  start(service::Pace::kLockstep);
  EXPECT_THAT(call("slam/save_map"), HasSubstr("failed: name a map"));
  EXPECT_THAT(call("slam/save_map", "room"), HasSubstr("failed: nothing was mapped"));
  EXPECT_THAT(call("slam/localize_only", "true"), HasSubstr("failed: there is no map"));
  std::uint64_t seq = 0;
  for (; seq < 30; ++seq) step(seq);
  const std::uint32_t keyframes = results_.all().back()->keyframes;
  EXPECT_THAT(call("slam/save_map", "room"),
              AllOf(HasSubstr(std::to_string(keyframes) + " keyframes"), HasSubstr(file_)));
  EXPECT_EQ(load_map_file(file_).keyframes.size(), keyframes);

  EXPECT_THAT(call("slam/localize_only", "true"), HasSubstr("only localizing"));
  for (; seq < 50; ++seq) step(seq);
  EXPECT_EQ(results_.all().back()->keyframes, keyframes) << "the map stays as it is";
  EXPECT_THAT(call("slam/localize_only", "false"), HasSubstr("the map grows again"));

  EXPECT_THAT(call("slam/reset"), HasSubstr(std::to_string(keyframes) + " keyframes"));
  step(seq++);
  EXPECT_EQ(results_.all().back()->keyframes, 1U) << "a new map";
  EXPECT_THAT(call("slam/load_map", "missing"), HasSubstr("failed: there is no readable map missing.rtdmap"));
  EXPECT_THAT(call("slam/load_map", "room.rtdmap"), HasSubstr(std::to_string(keyframes) + " keyframes"));
  for (const std::uint64_t end = seq + 5; seq < end; ++seq) step(seq);
  EXPECT_GE(results_.all().back()->keyframes, keyframes);
  EXPECT_EQ(results_.all().size(), seq) << "one result for each frame";
}

TEST_F(MapServiceTest, answers_what_is_asked_of_a_pose_a_keyframe_and_a_landmark) {
  start(service::Pace::kLockstep);
  EXPECT_THAT(call("slam/ask", "doubt"), HasSubstr("failed: the last frame has no measured pose"));
  for (std::uint64_t seq = 0; seq < 20; ++seq) step(seq);
  const auto doubt = nlohmann::json::parse(call("slam/ask", "doubt"));
  EXPECT_EQ(doubt["agree"], results_.all().back()->inliers);
  EXPECT_EQ(doubt["landmarks"].size(), doubt["disagree"]);
  const auto keyframe = nlohmann::json::parse(call("slam/ask", "keyframe 0"));
  EXPECT_GT(keyframe["landmarks"], 50);
  EXPECT_NEAR(keyframe["seen_s"][0].get<double>(), 1e-9 * static_cast<double>(results_.all().front()->stamp_ns), 1e-6);
  EXPECT_NEAR(keyframe["camera"]["cx"].get<double>(), 0.5, 0.05);
  EXPECT_THAT(call("slam/ask", "landmark 0 90 0 1"), HasSubstr("failed: the map has none there"));
  EXPECT_THAT(call("slam/ask", "keyframe 99999"), HasSubstr("failed: the map has none there"));
  for (const char* wrong : {"", "weather", "keyframe", "keyframe x", "landmark 0 1 2", "doubt 3", "landmark 0 nan 0 1"})
    EXPECT_THAT(call("slam/ask", wrong), HasSubstr("failed: ask 'doubt'")) << wrong;
}

/// What a peer may try with the name of a map. Nothing but "maps" may change.
class MapAttackTest : public MapServiceTest {
 protected:
  MapAttackTest() {
    std::filesystem::create_directories(maps_);
    std::ofstream(startup_) << "export PATH\n";
    config_.map.folder = maps_;
  }
  void map_something() {
    start(service::Pace::kLockstep);
    for (std::uint64_t seq = 0; seq < 3; ++seq) step(seq);
  }
  std::string startup() const { return io::try_read_file(startup_, io::kResults).value_or("gone"); }

  const std::filesystem::path maps_ = folder_ / "maps", startup_ = folder_ / ".profile";
};

TEST_F(MapAttackTest, a_path_is_never_written) {
  map_something();
  const std::string beside = (folder_ / "made.rtdmap").string();
  for (const std::string& name : {startup_.string(), std::string("../.profile"), beside, std::string("../made"),
                                  std::string("maps/../../made"), std::string(".profile")})
    EXPECT_THAT(call("slam/save_map", name), HasSubstr("failed: this is not a name of a map")) << name;
  EXPECT_EQ(startup(), "export PATH\n");
  EXPECT_FALSE(std::filesystem::exists(beside));
  EXPECT_TRUE(std::filesystem::is_empty(maps_));
}

TEST_F(MapAttackTest, prepared_links_lead_nowhere) {
  map_something();
  std::filesystem::create_symlink(startup_, maps_ / "room.rtdmap.tmp");
  EXPECT_THAT(call("slam/save_map", "room"), HasSubstr("saved to"));
  EXPECT_EQ(load_map_file(maps_ / "room.rtdmap", {}, io::Links::kRefuse).keyframes.size(),
            results_.all().back()->keyframes);
  std::filesystem::create_symlink(startup_, maps_ / "link.rtdmap");
  EXPECT_THAT(call("slam/save_map", "link"), HasSubstr("failed: link.rtdmap exists and is not a map"));
  std::filesystem::create_symlink(folder_ / "made", maps_ / "dangling.rtdmap");
  EXPECT_THAT(call("slam/save_map", "dangling"), HasSubstr("failed: dangling.rtdmap exists and is not a map"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "made"));
  EXPECT_EQ(startup(), "export PATH\n");
}

TEST_F(MapAttackTest, only_maps_are_replaced) {
  map_something();
  std::ofstream(maps_ / "notes.rtdmap") << "mine";
  EXPECT_THAT(call("slam/save_map", "notes"), HasSubstr("failed: notes.rtdmap exists and is not a map"));
  EXPECT_EQ(io::try_read_file(maps_ / "notes.rtdmap", io::kResults), "mine");
  EXPECT_THAT(call("slam/save_map", "room"), HasSubstr("saved to"));
  EXPECT_THAT(call("slam/save_map", "room"), HasSubstr("saved to")) << "its own map it may replace";
}

TEST_F(MapAttackTest, load_does_not_reveal_which_files_exist) {
  map_something();
  make_map();  // outside, readable, a map
  const std::string there = call("slam/load_map", file_), not_there = call("slam/load_map", file_ + "x");
  EXPECT_THAT(there, HasSubstr("failed: this is not a name of a map"));
  EXPECT_EQ(there, not_there);
  for (const char* name : {"/etc/passwd", "/etc/none", "../room", "../.profile"})
    EXPECT_EQ(call("slam/load_map", name), there) << name;
  std::filesystem::create_symlink(startup_, maps_ / "a.rtdmap");
  std::filesystem::create_symlink(file_, maps_ / "b.rtdmap");
  std::filesystem::create_symlink(folder_ / "none", maps_ / "c.rtdmap");
  for (const std::string name : {"a", "b", "c", "d"})
    EXPECT_EQ(call("slam/load_map", name),
              "failed: there is no readable map " + name + ".rtdmap in the folder of --maps-dir");
}

TEST_F(MapServiceTest, the_folder_of_maps_is_that_of_the_configured_file_else_of_the_run) {
  ServiceConfig config;
  EXPECT_EQ(maps_folder(config, ""), "");
  EXPECT_EQ(maps_folder(config, "/var/lib/rtd-slam"), "/var/lib/rtd-slam");
  config.out_dir = "run";
  EXPECT_EQ(maps_folder(config, "/var/lib/rtd-slam"), "run");
  config.map.save = "maps/room.rtdmap";
  EXPECT_EQ(maps_folder(config, ""), "maps");
  config.map.save = "room.rtdmap";
  EXPECT_EQ(maps_folder(config, ""), ".");
  config.map.folder = "/srv/maps";
  EXPECT_EQ(maps_folder(config, ""), "/srv/maps");
}

TEST_F(MapServiceTest, saves_its_map_while_it_runs) {
  config_.map.save = file_;
  config_.map.checkpoint_s = 0.02;
  start(service::Pace::kRealtime);
  std::uint64_t seq = 0;
  for (; seq < 5; ++seq) step(seq);
  ASSERT_TRUE(wait_saved(1));
  while (seq < 200 && results_.all().back()->keyframes < 3) step(seq++);
  EXPECT_TRUE(wait_saved(3)) << "a map that grew is saved again";
}

TEST_F(MapServiceTest, finds_its_place_in_a_loaded_map_and_leaves_the_file_alone) {
  make_map();
  const std::string before = bytes();
  config_.map.load = file_;
  config_.core.localize_only = true;
  start(service::Pace::kLockstep);
  for (std::uint64_t seq = 30; seq < 60; ++seq) step(seq);
  std::size_t tracked = 0;
  for (const auto& result : results_.all()) {
    if (result->state != msg::TrackingState::kOk) continue;
    ++tracked;
    const Eigen::Isometry3d T_truth_estimate =
        FeatureWorld::T_world_camera(result->seq).inverse() * msg::to_isometry(result->T_world_camera);
    EXPECT_LT(T_truth_estimate.translation().norm(), 2e-3);
  }
  EXPECT_GE(tracked, 28U) << "of 30";
  EXPECT_EQ(stop(), service::kOk);
  EXPECT_EQ(bytes(), before);
}

TEST_F(MapServiceTest, continues_a_loaded_map) {
  make_map();
  const std::size_t loaded = load_map_file(file_).keyframes.size();
  config_.map.load = config_.map.save = file_;
  start(service::Pace::kLockstep);
  for (std::uint64_t seq = 60; seq < 140; ++seq) step(seq);
  EXPECT_EQ(results_.all()[2]->state, msg::TrackingState::kOk);
  EXPECT_EQ(stop(), service::kOk);
  EXPECT_GT(load_map_file(file_).keyframes.size(), loaded);
}

TEST_F(MapServiceTest, reports_that_it_is_relocalizing) {
  make_map();
  config_.map.load = file_;
  start(service::Pace::kRealtime);
  auto empty = world_.view(0, Eigen::Isometry3d::Identity());
  empty->count = 0;
  ASSERT_TRUE(features_.write(*empty));
  ASSERT_TRUE(wait_state(msg::ServiceState::kDegraded, "relocalizing"));
  ASSERT_TRUE(results_.wait_count(1));  // comes on another topic than the state
  EXPECT_EQ(results_.all().back()->state, msg::TrackingState::kRelocalizing);
}

TEST_F(MapServiceTest, refuses_a_file_that_is_no_map) {
  config_.map.load = file_;
  launch(service::Pace::kLockstep);
  EXPECT_THAT([&] { running_code(); },
              ThrowsMessage<service::ConfigError>(AllOf(HasSubstr("slam.map.load"), HasSubstr("No such file"))));
  std::ofstream(file_) << "something else";
  launch(service::Pace::kLockstep);
  EXPECT_THAT([&] { running_code(); },
              ThrowsMessage<service::ConfigError>(AllOf(HasSubstr("room.rtdmap"), HasSubstr("not a map file"))));
  make_map();
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) / 2);
  launch(service::Pace::kLockstep);
  EXPECT_THAT([&] { running_code(); }, ThrowsMessage<service::ConfigError>(HasSubstr("damaged at byte")));
}

TEST_F(MapServiceTest, refuses_to_localize_without_a_map_or_to_save_what_does_not_change) {
  config_.core.localize_only = true;
  launch(service::Pace::kLockstep);
  EXPECT_THAT([&] { running_code(); }, ThrowsMessage<service::ConfigError>(HasSubstr("--map")));
  config_.map.load = config_.map.save = file_;
  launch(service::Pace::kLockstep);
  EXPECT_THAT([&] { running_code(); }, ThrowsMessage<service::ConfigError>(HasSubstr("slam.map.save")));
}

TEST_F(MapServiceTest, refuses_another_camera) {
  make_map();
  config_.map.load = file_;
  start(service::Pace::kLockstep);
  auto frame = world_.view(0, Eigen::Isometry3d::Identity());
  frame->intrinsics[0] = frame->intrinsics[1] = 365;
  ASSERT_TRUE(features_.write(*frame));
  EXPECT_EQ(running_code(), service::kUsageOrConfig);
}

TEST_F(MapServiceTest, gives_up_a_map_taken_before_the_first_frame_that_another_camera_made) {
  make_map();
  config_.map.folder = folder_;
  start(service::Pace::kLockstep);
  EXPECT_THAT(call("slam/load_map", "room"), HasSubstr("keyframes"));
  const auto step_with_other_camera = [&](std::uint64_t seq) {
    auto frame = world_.view(seq, FeatureWorld::T_world_camera(seq));
    frame->intrinsics[0] = frame->intrinsics[1] = 365;
    ASSERT_TRUE(features_.write(*frame));
    ASSERT_TRUE(results_.wait_count(seq + 1));
  };
  step_with_other_camera(0);
  EXPECT_EQ(results_.all().back()->keyframes, 1U) << "a new map";
  EXPECT_TRUE(wait_state(msg::ServiceState::kDegraded, "the map of slam/load_map is not used"));
  EXPECT_THAT(call("slam/reset"), HasSubstr("1 keyframes"));
  step_with_other_camera(1);
  EXPECT_TRUE(wait_state(msg::ServiceState::kRunning, ""));
}

TEST_F(MapServiceTest, keeps_tracking_and_reports_when_the_map_cannot_be_saved) {
  config_.map.save = (folder_ / "none" / "room.rtdmap").string();
  config_.map.checkpoint_s = 0.02;
  start(service::Pace::kRealtime);
  step(0);
  ASSERT_TRUE(wait_state(msg::ServiceState::kDegraded, "no such folder"));
  step(1);
  EXPECT_EQ(results_.all().back()->state, msg::TrackingState::kOk);
  EXPECT_EQ(stop(), service::kRunFailed);
}

TEST(MapKeeper, saves_to_any_file_while_the_system_runs) {
  const rtd::test::TemporaryFolder folder;
  SlamSystem slam(test_support::settled(), MappingMode::kSynchronous, [] { return 0; });
  MapKeeper keeper(MapFileConfig{}, slam);
  EXPECT_THAT([&] { keeper.save_to(folder / "empty.rtdmap"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("nothing was mapped")));
  const FeatureWorld world({});
  for (std::uint64_t seq = 0; seq < 30; ++seq) slam.process(*world.view(seq));
  const SavedMap saved = keeper.save_to(folder / "room.rtdmap");
  const MapContents contents = load_map_file(folder / "room.rtdmap");
  EXPECT_EQ(saved.keyframes, contents.keyframes.size());
  EXPECT_EQ(saved.landmarks, contents.landmarks.size());
  EXPECT_EQ(saved.bytes, std::filesystem::file_size(folder / "room.rtdmap"));
  EXPECT_THROW(keeper.save_to(folder / "none" / "room.rtdmap"), std::runtime_error);
  EXPECT_TRUE(keeper.save_at_end()) << "no file is configured";
  for (std::uint64_t seq = 30; seq < 40; ++seq) slam.process(*world.view(seq));
  slam.load_map(load_map_file(folder / "room.rtdmap"));
  EXPECT_EQ(slam.keyframes().size(), saved.keyframes);
}

}  // namespace
}  // namespace rtd::slam
