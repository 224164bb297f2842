// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "services/slam/core/corrections.hpp"
#include "services/slam/core/mapping/mapping_steps.hpp"
#include "tests/support/feature_world.hpp"

namespace rtd::slam {
namespace {

using test_support::FeatureWorld;

/// A map of one keyframe, and the frame after it, recorded 3 cm off while half of its features were in question.
class UnsettledFramesTest : public ::testing::Test {
 protected:
  UnsettledFramesTest() {
    const KeyframeId keyframe =
        map_.add_keyframe(make_frame(*world_.view(0), {}).frame, FeatureWorld::T_world_camera(0), kNoKeyframe);
    create_from_depth(map_, keyframe, 10);
    local_ = make_local_map(map_, keyframe, 1, 60);
    Eigen::Isometry3d T_off = FeatureWorld::T_world_camera(1);
    T_off.translation().x() += 0.03;
    records_.push_back({1, FeatureWorld::stamp_ns(1), keyframe, FeatureWorld::T_world_camera(0).inverse() * T_off});
  }
  void add(std::uint64_t seq, bool in_question) {
    auto message = world_.view(seq);
    for (std::uint32_t i = 0; in_question && i < message->count; i += 2)
      message->features[i].flags |= msg::kFeatureInQuestion;
    TrackedFrame tracked;
    tracked.frame = make_frame(*message, {}).frame;
    tracked.landmarks.assign(tracked.frame->features.size(), kNoLandmark);
    frames_.add(tracked, *local_, {config_, [] { return std::int64_t{0}; }}, records_);
  }
  double error_m() const {
    const Eigen::Isometry3d T_world_camera = FeatureWorld::T_world_camera(0) * records_[0].T_reference_camera;
    return (T_world_camera.translation() - FeatureWorld::T_world_camera(1).translation()).norm();
  }

  const FeatureWorld world_ = FeatureWorld({});
  const SlamConfig config_;
  Map map_;
  LocalMapPtr local_;
  std::vector<FrameRecord> records_;
  DeferredFrames frames_;
};

TEST_F(UnsettledFramesTest, are_judged_again_when_nothing_is_in_question_for_a_while) {
  add(1, true);
  add(5, false);  // 0.13 s
  EXPECT_NEAR(error_m(), 0.03, 1e-9);
  add(12, false);
  EXPECT_LT(error_m(), 0.002);
}

TEST_F(UnsettledFramesTest, keep_their_pose_when_nothing_was_in_question) {
  add(1, false);
  add(20, false);
  EXPECT_NEAR(error_m(), 0.03, 1e-9);
}

TEST_F(UnsettledFramesTest, keep_their_pose_without_their_keyframe) {
  records_[0].reference = 7;
  add(1, true);
  add(20, false);
  EXPECT_NEAR(error_m(), 0.03, 1e-9);
}

TEST_F(UnsettledFramesTest, that_are_no_longer_recorded_do_not_count) {
  records_[0].seq = 99;
  add(1, true);
  add(20, false);
  EXPECT_NEAR(error_m(), 0.03, 1e-9);
}

}  // namespace
}  // namespace rtd::slam
