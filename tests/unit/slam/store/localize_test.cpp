// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// A map from a file is found back in, and changed or not as was asked.
#include <gmock/gmock.h>

#include "common/msg/transform_eigen.hpp"
#include "services/slam/core/slam_system.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/unit/slam/store/memory_map_file.hpp"

namespace rtd::slam {
namespace {

using msg::TrackingState;
using test_support::FeatureWorld;
using test_support::frozen_clock;
using ::testing::HasSubstr;

FeatureWorld::Options noisy(std::uint64_t seed = 1) {
  FeatureWorld::Options options;
  options.noise_px = 0.5;
  options.depth_noise_factor = 0.0015;
  options.flipped_bits = 12;
  options.seed = seed;
  return options;
}

io::Bytes map_of(const SlamSystem& slam) {
  return slam.read_map([](const Map& map) { return bytes_of_map(map); });
}

/// The map of a first session, as a file.
io::Bytes make_map(const FeatureWorld& world, std::uint64_t frames) {
  SlamSystem slam(SlamConfig{}, MappingMode::kSynchronous, frozen_clock);
  for (std::uint64_t seq = 0; seq < frames; ++seq) slam.process(*world.view(seq));
  return map_of(slam);
}

double position_error_m(const SlamOutput& output, std::uint64_t seq) {
  return (output.result.T_world_camera.translation() - FeatureWorld::T_world_camera(seq).translation()).norm();
}

class LoadedMap : public ::testing::Test {
 protected:
  SlamSystem restart(bool localize_only, MappingMode mode = MappingMode::kSynchronous) const {
    SlamConfig config;
    config.localize_only = localize_only;
    return {config, mode, frozen_clock};
  }
  std::unique_ptr<msg::FeatureFrame> view(std::uint64_t seq) const {
    return world_.view(seq, FeatureWorld::T_world_camera(seq));
  }

  /// Frames from `seq` on until the first pose, at most so many as a recognised place must be confirmed by.
  SlamOutput find_back(SlamSystem& slam, std::uint64_t& seq) const {
    SlamOutput output;
    for (int frame = 0; frame < 3; ++frame) {
      output = slam.process(*view(seq++));
      if (output.result.state == TrackingState::kOk) break;
      EXPECT_EQ(output.result.state, TrackingState::kRelocalizing);
    }
    EXPECT_EQ(output.result.state, TrackingState::kOk) << output.problem;
    EXPECT_LT(position_error_m(output, seq - 1), 0.01);
    return output;
  }

  static constexpr std::uint64_t kMapped = 90;
  const FeatureWorld world_{noisy()};
  const io::Bytes file_ = make_map(world_, kMapped);
};

TEST_F(LoadedMap, is_found_at_once_and_left_as_it_is) {
  SlamSystem slam = restart(true);
  slam.restore(read_bytes(file_));
  std::uint64_t seq = 40;
  find_back(slam, seq);
  for (; seq < kMapped; ++seq) {
    const SlamOutput output = slam.process(*view(seq));
    ASSERT_EQ(output.result.state, TrackingState::kOk) << "frame " << seq << ": " << output.problem;
    EXPECT_LT(position_error_m(output, seq), 0.01) << "frame " << seq;
    EXPECT_TRUE(output.changes.empty());
  }
  EXPECT_EQ(map_of(slam), file_);
}

TEST_F(LoadedMap, is_left_as_it_is_by_a_mapper_thread_too) {
  SlamSystem slam = restart(true, MappingMode::kThreaded);
  slam.restore(read_bytes(file_));
  for (std::uint64_t seq = 0; seq < kMapped; ++seq) slam.process(*view(seq));
  slam.finish();
  EXPECT_EQ(map_of(slam), file_);
}

TEST_F(LoadedMap, gives_no_pose_before_it_is_found) {
  SlamSystem slam = restart(true);
  slam.restore(read_bytes(file_));
  const FeatureWorld elsewhere(noisy(2));
  std::uint64_t seq = 0;
  for (; seq < 120; ++seq) {
    const SlamOutput output = slam.process(*elsewhere.view(seq, FeatureWorld::T_world_camera(seq)));
    ASSERT_EQ(output.result.state, TrackingState::kRelocalizing) << "frame " << seq;
    EXPECT_THAT(output.problem, HasSubstr("relocalizing"));
  }
  EXPECT_EQ(slam.frames_tracked(), 0U);
  find_back(slam, seq);
  EXPECT_EQ(map_of(slam), file_);
}

TEST_F(LoadedMap, is_kept_when_a_new_one_begins_elsewhere) {
  SlamSystem slam = restart(false);
  slam.restore(read_bytes(file_));
  const FeatureWorld elsewhere(noisy(2));
  for (std::uint64_t seq = 0; seq < 120; ++seq) slam.process(*elsewhere.view(seq, FeatureWorld::T_world_camera(seq)));
  EXPECT_THAT(slam.maps(), ::testing::ElementsAre(0, 1));
  EXPECT_FALSE(slam.trajectory(1).empty());
  EXPECT_TRUE(slam.trajectory(0).empty());
  slam.read_map([](const Map& map) { EXPECT_EQ(map.check_invariants(), ""); });
}

TEST_F(LoadedMap, frame_that_cannot_be_used_does_not_end_the_search) {
  SlamSystem slam = restart(true);
  slam.restore(read_bytes(file_));
  auto broken = view(0);
  broken->intrinsics = {};
  EXPECT_EQ(slam.process(*broken).result.state, TrackingState::kRelocalizing);
  std::uint64_t seq = 1;
  find_back(slam, seq);
}

TEST_F(LoadedMap, grows_when_mapping_continues) {
  SlamSystem slam = restart(false);
  slam.restore(read_bytes(file_));
  const KeyframeId first_free = slam.read_map([](const Map& map) { return map.next_keyframe(); });
  std::uint64_t seq = kMapped;
  find_back(slam, seq);
  for (; seq < kMapped + 60; ++seq) {
    const SlamOutput output = slam.process(*view(seq));
    ASSERT_EQ(output.result.state, TrackingState::kOk) << "frame " << seq << ": " << output.problem;
    EXPECT_LT(position_error_m(output, seq), 0.015) << "frame " << seq;
    for (const KeyframeChange& change : output.changes) {
      EXPECT_GE(change.id, first_free) << "others do not know the frames of the loaded keyframes";
    }
  }
  slam.read_map([&](const Map& map) {
    EXPECT_EQ(map.check_invariants(), "");
    EXPECT_GT(map.next_keyframe(), first_free);
  });
  EXPECT_GE(slam.trajectory().size(), 58U);
}

}  // namespace
}  // namespace rtd::slam
