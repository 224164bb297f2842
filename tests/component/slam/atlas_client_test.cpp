// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// A robot that asks where it is, and an atlas that has mapped the place before.
#include <gmock/gmock.h>
#include <spdlog/sinks/base_sink.h>

#include "common/io/byte_sink.hpp"
#include "common/msg/transform_eigen.hpp"
#include "services/slam/slam_service.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/service_fixture.hpp"
#include "tests/support/settled_map.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;
using test_support::FeatureWorld;
using test_support::Inbox;

class LogInbox : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit LogInbox(const Inbox<std::string>& lines) : lines_(lines) {}

 private:
  void sink_it_(const spdlog::details::log_msg& line) override {
    lines_.take(std::make_shared<std::string>(line.payload.data(), line.payload.size()));
  }
  void flush_() override {}

  const Inbox<std::string> lines_;
};

class AtlasClientTest : public test_support::ServiceFixture<SlamService> {
 protected:
  AtlasClientTest() : features_(bus_->writer(bus::topics::kFeatures)) {
    receive(bus::topics::kTracking, results_);
    receive(bus::topics::kKeyframeFeatures, queries_);
    config_.core = test_support::settled();
    spdlog::default_logger()->sinks().push_back(std::make_shared<LogInbox>(log_));
  }
  ~AtlasClientTest() override { spdlog::default_logger()->sinks().pop_back(); }

  /// The atlas, and a robot at `place` that has asked it.
  void start_asking(std::uint64_t place) {
    submaps_ = bus_->writer(bus::topics::kSubmap);
    start(service::Pace::kRealtime);
    step(place);
    ASSERT_TRUE(queries_.wait_count(1));
  }
  /// One more frame of a camera that is where it is in frame `place` of the world.
  TrackingState step(std::uint64_t place, std::int64_t after_ms = 33) {
    auto frame = seen_->view(place);
    frame->seq = frames_++;
    frame->stamp_ns = now_ns_ += 1'000'000 * after_ms;
    EXPECT_TRUE(features_.write(*frame));
    EXPECT_TRUE(results_.wait_count(frames_)) << "every frame has a result";
    return results_.all().back()->state;
  }
  /// The camera is found in a map of the world that it sees, after less than a second at `place` and behind it.
  void expect_found(std::uint64_t place) {
    ASSERT_TRUE(rest_until(place, "event=submap_taken keyframes="));
    EXPECT_EQ(step(place), TrackingState::kRelocalizing);
    const std::uint64_t give_up = place + 30;
    while (step(place) != TrackingState::kOk) ASSERT_LT(++place, give_up) << "not found in the map";
    for (const std::uint64_t end = place + 5; place < end;) {
      ASSERT_EQ(step(++place), TrackingState::kOk);
      const Eigen::Isometry3d T_world_camera = msg::to_isometry(results_.all().back()->T_world_camera);
      EXPECT_LT((FeatureWorld::T_world_camera(place).inverse() * T_world_camera).translation().norm(), 5e-3) << "m";
    }
  }
  /// Frames a millisecond apart, of a camera at rest, until the log has this.
  bool rest_until(std::uint64_t place, const std::string& event) {
    for (int i = 0; i < 2000 && !logged(event); ++i) step(place, 1);
    return logged(event);
  }
  bool logged(const std::string& text) const {
    const auto lines = log_.all();
    return std::ranges::any_of(lines, [&](const auto& line) { return line->find(text) != std::string::npos; });
  }
  bool answer(std::vector<std::uint8_t> file) {
    const msg::Transform T = msg::to_message(Eigen::Isometry3d::Identity());
    return submaps_.write({queries_.all().back()->stamp_ns, T, std::move(file)});
  }
  /// A map of the first 60 frames.
  static std::vector<std::uint8_t> map_of(const FeatureWorld& world, double fx_px = FeatureWorld::kFx) {
    SlamSystem slam(test_support::settled(), MappingMode::kSynchronous, test_support::frozen_clock);
    for (std::uint64_t seq = 0; seq < 60; ++seq) {
      auto frame = world.view(seq);
      frame->intrinsics[0] = frame->intrinsics[1] = fx_px;
      slam.process(*frame);
    }
    io::MemorySink sink;
    slam.read_map([&](const Map& map) { write_map(take_snapshot(map), sink); });
    std::vector<std::uint8_t> bytes;
    for (const std::byte byte : sink.bytes()) bytes.push_back(std::to_integer<std::uint8_t>(byte));
    return bytes;
  }

  const FeatureWorld world_{{}}, elsewhere_{{.seed = 2}};
  const FeatureWorld* seen_ = &world_;  ///< by the camera
  Inbox<msg::TrackingResult> results_;
  Inbox<msg::KeyframeFeatures> queries_;
  Inbox<std::string> log_;
  bus::Writer<msg::FeatureFrame> features_;
  bus::Writer<msg::Submap> submaps_;
  std::uint64_t frames_ = 0;
  std::int64_t now_ns_ = 1'000'000'000;
};

TEST_F(AtlasClientTest, a_robot_that_starts_continues_in_the_map_that_it_is_sent) {
  start_asking(30);
  const msg::KeyframeFeatures query = *queries_.all().front();
  EXPECT_EQ(query.keyframe_id, msg::kNoId);
  EXPECT_EQ(query.stamp_ns, now_ns_);
  EXPECT_EQ(query.features.size(), world_.view(30)->count);
  ASSERT_TRUE(answer(map_of(world_)));
  expect_found(30);
}

TEST_F(AtlasClientTest, a_robot_that_is_lost_continues_in_the_map_that_it_is_sent) {
  start_asking(30);
  for (int i = 0; i < 100; ++i) step(30);
  const std::size_t asked = queries_.all().size();
  seen_ = &elsewhere_;
  for (int i = 0; i < 100 && queries_.all().size() == asked; ++i) step(30);
  ASSERT_EQ(results_.all().back()->state, TrackingState::kLost);
  ASSERT_GT(queries_.all().size(), asked);
  ASSERT_TRUE(answer(map_of(elsewhere_)));
  expect_found(30);
}

TEST_F(AtlasClientTest, a_map_in_which_the_camera_is_not_found_is_given_up) {
  start_asking(30);
  ASSERT_TRUE(answer(map_of(elsewhere_)));
  ASSERT_TRUE(rest_until(30, "event=submap_taken"));
  const std::size_t asked = queries_.all().size();
  for (int i = 0; i < 100 && !logged("event=submap_given_up"); ++i) step(30);
  ASSERT_TRUE(logged("event=submap_given_up"));
  EXPECT_EQ(step(30), TrackingState::kOk);
  EXPECT_EQ(results_.all().back()->keyframes, 1U) << "a new map";
  for (int i = 0; i < 60; ++i) step(30);
  EXPECT_EQ(queries_.all().size(), asked) << "none is taken for a while";
}

TEST_F(AtlasClientTest, a_damaged_map_is_refused_and_the_run_continues) {
  start_asking(30);
  std::vector<std::uint8_t> file = map_of(world_);
  file[file.size() / 2] ^= 1;
  ASSERT_TRUE(answer(file));
  ASSERT_TRUE(rest_until(30, "event=submap_refused cause=\"the map file is damaged"));
  for (std::uint64_t place = 31; place < 60; ++place) EXPECT_EQ(step(place), TrackingState::kOk);
  EXPECT_EQ(results_.all().back()->map_id, 0U);
}

TEST_F(AtlasClientTest, a_map_of_another_kind_of_camera_is_refused_and_the_run_continues) {
  start_asking(30);
  ASSERT_TRUE(answer(map_of(world_, 365)));
  ASSERT_TRUE(rest_until(30, "event=submap_refused cause=\"the camera (640x480"));
  for (std::uint64_t place = 31; place < 60; ++place) EXPECT_EQ(step(place), TrackingState::kOk);
}

TEST_F(AtlasClientTest, a_map_that_was_not_asked_for_is_ignored) {
  start_asking(30);
  const std::vector<std::uint8_t> file = map_of(world_);
  const msg::Transform T = msg::to_message(Eigen::Isometry3d::Identity());
  ASSERT_TRUE(submaps_.write({queries_.all().front()->stamp_ns - 1, T, file}));
  for (std::uint64_t place = 31; place < 60; ++place) EXPECT_EQ(step(place), TrackingState::kOk);
  EXPECT_FALSE(logged("event=submap"));
}

TEST_F(AtlasClientTest, nothing_is_asked_without_an_atlas) {
  start(service::Pace::kRealtime);
  for (std::uint64_t place = 0; place < 30; ++place) step(place);
  EXPECT_TRUE(queries_.all().empty());
}

TEST_F(AtlasClientTest, nothing_is_asked_at_pace_lockstep) {
  submaps_ = bus_->writer(bus::topics::kSubmap);
  start(service::Pace::kLockstep);
  for (std::uint64_t place = 0; place < 30; ++place) step(place);
  EXPECT_TRUE(queries_.all().empty());
}

TEST_F(AtlasClientTest, nothing_is_asked_where_it_is_switched_off) {
  config_.atlas.ask = false;
  submaps_ = bus_->writer(bus::topics::kSubmap);
  start(service::Pace::kRealtime);
  for (std::uint64_t place = 0; place < 30; ++place) step(place);
  EXPECT_TRUE(queries_.all().empty());
}

}  // namespace
}  // namespace rtd::slam
