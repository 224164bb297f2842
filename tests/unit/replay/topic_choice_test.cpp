// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/replay/core/topic_choice.hpp"

#include <gmock/gmock.h>

#include "common/service/config.hpp"

namespace rtd::replay {
namespace {

using testing::ElementsAre;
using testing::Pair;

TEST(TopicChoice, plays_all_but_the_heartbeats_unless_asked) {
  EXPECT_TRUE(TopicChoice({}, {}).wants("rtd/frame"));
  EXPECT_FALSE(TopicChoice({}, {}).wants("rtd/status"));
  EXPECT_TRUE(TopicChoice({"rtd/status"}, {}).wants("rtd/status"));
}

TEST(TopicChoice, knows_the_topics_that_a_run_publishes_itself) {
  for (const char* topic : {"rtd/frame", "rtd/status", "rt/slam/pose", "rt/detector/detections"})
    EXPECT_TRUE(is_run_topic(topic)) << topic;
  for (const char* topic : {"rt/camera/color/image_raw", "rt/tf", "rt/slammed", "imu"})
    EXPECT_FALSE(is_run_topic(topic)) << topic;
}

TEST(TopicChoice, takes_patterns_on_either_spelling_of_a_name) {
  const TopicChoice choice({"/slam/*", "rt/tf"}, {"*/path"});
  EXPECT_TRUE(choice.wants("/slam/pose"));
  EXPECT_TRUE(choice.wants("/tf"));
  EXPECT_FALSE(choice.wants("/slam/path"));
  EXPECT_FALSE(choice.wants("rtd/frame"));
  EXPECT_TRUE(TopicChoice({"rt/slam/pose"}, {}).wants("/slam/pose"));
}

TEST(TopicChoice, names_the_patterns_that_meet_nothing) {
  EXPECT_THAT(TopicChoice({"/slam/*", "rtd/farme"}, {}).unmet({"/slam/pose", "rtd/frame"}), ElementsAre("rtd/farme"));
}

TEST(TopicChoice, patterns_may_leave_out_the_name_of_a_robot) {
  const TopicChoice choice({"/slam/*", "rtd/frame"}, {}), all({}, {});
  EXPECT_TRUE(choice.wants("/anna/slam/pose"));
  EXPECT_TRUE(choice.wants("rtd/anna/frame"));
  EXPECT_FALSE(choice.wants("rtd/anna/features"));
  EXPECT_FALSE(all.wants("rtd/anna/status")) << "heartbeats, as those of a robot without a name";
  EXPECT_TRUE(is_run_topic("rtd/anna/frame"));
  EXPECT_TRUE(is_run_topic("rt/anna/slam/pose"));
}

TEST(Remap, takes_both_spellings) {
  EXPECT_THAT(parse_remaps({"/slam/pose:=/old/pose", "rtd/frame:=rtd/frame2"}),
              ElementsAre(Pair("rt/slam/pose", "rt/old/pose"), Pair("rtd/frame", "rtd/frame2")));
}

TEST(Remap, refuses_what_is_no_renaming) {
  for (const char* wrong : {"/a", "/a:/b", ":=/b", "/a:=", "/a b:=/c", "/a*:=/b"})
    EXPECT_THROW(parse_remaps({wrong}), service::ConfigError) << wrong;
  EXPECT_THROW(parse_remaps({"/a:=/b", "rt/a:=/c"}), service::ConfigError);
}

}  // namespace
}  // namespace rtd::replay
