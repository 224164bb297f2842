// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "common/msg/plausible.hpp"
#include "services/slam/core/mapping/mapper.hpp"
#include "services/slam/core/tracking/tracker.hpp"
#include "services/slam/keyframe_sender.hpp"
#include "tests/support/feature_world.hpp"
#include "tests/support/settled_map.hpp"

namespace rtd::slam {
namespace {

using msg::kNoId;
using ::testing::ElementsAre;

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

constexpr float kMeasured_m = 2.1F;
/// The features of each keyframe, and what the landmarks of the first five are.
enum : std::uint32_t { kWitness, kSeenOften, kSeenTwice, kUnmeasured, kOnPerson, kWithoutLandmark, kFeatures };

FramePtr make_test_frame(std::int64_t stamp_ns) {
  auto frame = std::make_shared<Frame>();
  frame->stamp_ns = stamp_ns;
  frame->camera = {520, 521, 320, 240, 40};
  frame->width_px = 640;
  frame->height_px = 480;
  frame->readout_s = -0.02;
  for (std::uint32_t i = 0; i < kFeatures; ++i) {
    msg::Feature feature{};
    feature.u_px = static_cast<float>(i + 1);
    feature.v_px = 7;
    feature.depth_m = i == kUnmeasured ? 0 : kMeasured_m;
    feature.static_probability = 0.75F;
    feature.octave = 3;
    feature.flags = i == kOnPerson ? msg::kFeatureInHighMask : msg::kFeatureInLowMask;
    feature.descriptor.fill(static_cast<std::uint8_t>(i));
    frame->features.push_back(feature);
  }
  return frame;
}

/// Three keyframes, each half a metre in front of the one before; all landmarks are 2 m in front of the first.
Map make_map() {
  Map map;
  for (KeyframeId k = 0; k < 3; ++k)
    map.add_keyframe(make_test_frame(k), Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.5 * k)),
                     k == 0 ? kNoKeyframe : k - 1);
  for (std::uint32_t feature = 0; feature <= kOnPerson; ++feature) {
    const LandmarkId id = map.add_landmark({0, 0, 2}, {0, feature});
    map.add_observation(id, {1, feature});
    if (feature != kSeenTwice) map.add_observation(id, {2, feature});
    map.find_landmark(id)->witness = feature != kSeenOften && feature != kSeenTwice;
  }
  return map;
}

std::vector<std::uint32_t> landmarks_of(const msg::KeyframeFeatures& message) {
  std::vector<std::uint32_t> ids;
  for (const msg::KeyframeFeature& feature : message.features) ids.push_back(feature.landmark_id);
  return ids;
}

TEST(KeyframeFeatures, those_of_witnesses_have_landmark_and_present_depth) {
  const Map map = make_map();
  const msg::KeyframeFeatures message = make_features(map, *map.find_keyframe(1), true);
  EXPECT_EQ(message.keyframe_id, 1U);
  EXPECT_EQ(message.stamp_ns, 1);
  EXPECT_THAT(landmarks_of(message), ElementsAre(kWitness, kNoId, kNoId, kNoId, kNoId)) << "none on a person";
  EXPECT_FLOAT_EQ(message.features[kWitness].depth_m, 1.5F) << "from this camera, by the map";
  EXPECT_FLOAT_EQ(message.features[kSeenOften].depth_m, kMeasured_m);
  EXPECT_EQ(message.features[kUnmeasured].depth_m, 0);
  EXPECT_EQ(message.features.back().descriptor[0], kWithoutLandmark);
}

TEST(KeyframeFeatures, without_witnesses_landmarks_that_three_keyframes_see_count) {
  const Map map = make_map();
  EXPECT_THAT(landmarks_of(make_features(map, *map.find_keyframe(0), false)),
              ElementsAre(kWitness, kSeenOften, kNoId, kNoId, kNoId));
}

TEST(KeyframeFeatures, a_landmark_behind_the_camera_is_none) {
  Map map = make_map();
  map.find_landmark(kWitness)->position.z() = 0.4;
  EXPECT_THAT(landmarks_of(make_features(map, *map.find_keyframe(1), true)),
              ElementsAre(kNoId, kNoId, kNoId, kNoId, kNoId));
}

TEST(KeyframeFeatures, of_a_frame_are_as_measured_and_receivers_take_them) {
  const msg::KeyframeFeatures message = make_features(*make_test_frame(17));
  EXPECT_EQ(message.keyframe_id, kNoId) << "where is this?";
  EXPECT_EQ(message.stamp_ns, 17);
  EXPECT_THAT(message.intrinsics, ElementsAre(520, 521, 320, 240));
  EXPECT_EQ(message.disparity_px_m, 40);
  EXPECT_EQ(message.width, 640U);
  EXPECT_EQ(message.height, 480U);
  EXPECT_THAT(landmarks_of(message), ElementsAre(kNoId, kNoId, kNoId, kNoId, kNoId));
  const msg::KeyframeFeature& feature = message.features.front();
  EXPECT_EQ(feature.u_px, 1);
  EXPECT_EQ(feature.v_px, 7);
  EXPECT_EQ(feature.depth_m, kMeasured_m);
  EXPECT_EQ(feature.static_probability, 0.75F);
  EXPECT_EQ(feature.octave, 3);
  EXPECT_EQ(feature.flags, msg::kFeatureInLowMask);
  EXPECT_EQ(msg::to_string(msg::implausible_field(message)), "")
      << "also with a readout from the last row to the first";
}

}  // namespace
}  // namespace rtd::slam
