// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/slam/core/mapping/mapper.hpp"

#include <gtest/gtest.h>

#include "services/slam/core/tracking/tracker.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/settled_map.hpp"

namespace rtd::slam {
namespace {

/// Makes a keyframe of every frame of a walk at 30 Hz: how many of the last 20 a bundle adjustment moved at once.
int count_adjusted(double ba_gap_s) {
  constexpr std::uint64_t kFrames = 32, kCounted = 20;
  SlamConfig config = test_support::settled();
  config.mapper.ba_gap_s = ba_gap_s;
  config.mapper.redundant_ratio = 1;
  const test_support::FeatureWorld world = test_support::FeatureWorld::noisy();
  Mapper mapper(config);
  Tracker tracker(config, [] { return std::int64_t{0}; });
  KeyframeProposal first;
  first.frame = make_frame(*world.view(0), config.sensor).frame;
  first.landmarks.assign(first.frame->features.size(), kNoLandmark);
  LocalMapPtr snapshot = mapper.local_map(mapper.insert(first, {}));
  tracker.initialize(first.frame, snapshot);
  int adjusted = 0;
  for (std::uint64_t seq = 1; seq < kFrames; ++seq) {
    const TrackOutcome outcome = tracker.track(make_frame(*world.view(seq), config.sensor).frame, snapshot);
    EXPECT_EQ(outcome.state, msg::TrackingState::kOk) << seq;
    const KeyframeProposal proposal = tracker.propose_keyframe();
    const Eigen::Isometry3d T_world_reference = mapper.map().T_world_keyframe(proposal.reference);
    const KeyframeId inserted = mapper.insert(proposal, {});
    const Eigen::Isometry3d proposed = T_world_reference * proposal.T_reference_camera;
    const Keyframe* keyframe = mapper.map().find_keyframe(inserted);
    if (seq >= kFrames - kCounted && !keyframe->T_world_camera.isApprox(proposed, 1e-7)) ++adjusted;
    snapshot = mapper.local_map(inserted);
  }
  return adjusted;
}

TEST(Mapper, adjusts_a_grown_map_at_most_ten_times_a_second) {
  EXPECT_EQ(count_adjusted(0), 20) << "after every keyframe";
  EXPECT_EQ(count_adjusted(0.1), 5) << "33.3 ms apart: every fourth";
}

}  // namespace
}  // namespace rtd::slam
