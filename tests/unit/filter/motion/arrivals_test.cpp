// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/motion/dynamic_regions.hpp"

#include <gtest/gtest.h>

namespace rtd::filter {
namespace {

constexpr std::size_t kSurfaceCells = 100;

/// One surface that keyframes saw through and recent views saw at its place.
class Arrivals : public ::testing::Test {
 protected:
  DepthEvidence accept() { return accept_arrivals(evidence_, clusters_, votes_, old_votes_, GeometryConfig{}); }
  DepthClusters clusters_{{10, 10}, std::vector<std::int32_t>(kSurfaceCells, 0), {100}};
  FeatureVotes votes_{{}, {40}, {0}}, old_votes_{{}, {30}, {0}};
  DepthEvidence evidence_ = [] {
    DepthEvidence evidence = DepthEvidence::none(kSurfaceCells);
    evidence.violated.assign(kSurfaceCells, 1);
    evidence.settled.assign(kSurfaceCells, 1);
    return evidence;
  }();
};

TEST_F(Arrivals, are_at_rest_when_their_features_are) {
  EXPECT_EQ(accept().violated, std::vector<std::uint8_t>(kSurfaceCells, 0));
  EXPECT_EQ(accept().lasting, std::vector<std::uint8_t>(kSurfaceCells, 1));
}

TEST_F(Arrivals, are_none_while_features_are_displaced_or_few) {
  votes_.moving = {10};
  EXPECT_EQ(accept().violated, evidence_.violated);
  votes_ = {{}, {5}, {0}};
  EXPECT_EQ(accept().violated, evidence_.violated);
}

TEST_F(Arrivals, are_none_while_their_features_are_new_at_the_place) {
  old_votes_ = {{}, {5}, {0}};
  EXPECT_EQ(accept().violated, evidence_.violated);
}

TEST_F(Arrivals, are_none_while_a_recent_view_sees_through_part_of_the_surface) {
  for (std::size_t cell = 0; cell < 6; ++cell) evidence_.settled[cell] = 0;
  EXPECT_EQ(accept().violated, evidence_.violated);
}

}  // namespace
}  // namespace rtd::filter
