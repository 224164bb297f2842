// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/robot_feed.hpp"

#include <gmock/gmock.h>

namespace rtd::viewer {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(ShownRobots, are_those_with_topics_of_their_own) {
  EXPECT_THAT(shown_robots({"rtd/anna/status", "rt/bert/slam/odometry", "rtd/status"}), ElementsAre("anna", "bert"));
  EXPECT_THAT(shown_robots({"rtd/status", "rtd/frame"}), ElementsAre(""));
  EXPECT_THAT(shown_robots({"rtd/anna/status", "rtd/atlas", "rt/atlas/points"}), ElementsAre("anna"));
  EXPECT_THAT(shown_robots({"rr/recorder/startReply", "rtd/anna/status"}), ElementsAre("", "anna"));
}

TEST(ShownRobots, the_viewer_itself_and_shared_topics_are_no_robot) {
  EXPECT_THAT(shown_robots({}), IsEmpty());
  EXPECT_THAT(shown_robots({"rtd/status", "rtd/schemas", "rt/tf", "rt/diagnostics", "rt/camera/color/image_raw"}),
              IsEmpty());
}

}  // namespace
}  // namespace rtd::viewer
