// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/topics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "common/bus/backend.hpp"
#include "common/bus/frame_topics.hpp"
#include "common/bus/qos.hpp"

namespace rtd::bus {
namespace {

struct TopicFacts {
  std::string name;
  MessageId type;
  QosProfile profile;
  bool plain;
};

template <class T>
TopicFacts facts(const Topic<T>& topic) {
  return {topic.name, MessageTraits<T>::kId, topic.profile, MessageTraits<T>::kPlain};
}

std::vector<TopicFacts> all_topics() {
  using namespace topics;
  return {facts(kFrame),
          facts(kFeatures),
          facts(kKeyframes),
          facts(kTracking),
          facts(kStatus),
          facts(kColorJpeg),
          facts(kCameraInfo),
          facts(kDetections),
          facts(kOdometry),
          facts(kPose),
          facts(kTf),
          facts(kPath),
          facts(kMapPoints),
          facts(kDiagnostics),
          facts(kDynamicMask),
          facts(kDensePoints),
          facts(kMap),
          facts(kMovers),
          facts(kGroundTruth),
          facts(kMoverBoxes),
          facts(kMoverMarkers),
          facts(kTfStatic),
          facts(kOccupancyGrid),
          facts(kPersonMasks),
          facts(kMapJumps),
          facts(kDepthJpeg),
          facts(kKeyframeFeatures),
          facts(kKeyframeRequest),
          facts(kSubmap),
          facts(kAtlas),
          facts(kAtlasRobots),
          facts(kAtlasPoints),
          facts(kAtlasFloorPlan),
          facts(kAtlasMapJumps)};
}

TEST(Topics, have_names_of_their_own) {
  std::set<std::string> names;
  for (const TopicFacts& topic : all_topics()) EXPECT_TRUE(names.insert(topic.name).second) << topic.name;
}

TEST(Topics, standard_types_go_where_ros2_looks_and_our_own_do_not) {
  for (const TopicFacts& topic : all_topics()) {
    const bool own_type = visit_message_type(topic.type, []<class T>() {
      return std::string_view(msg::type_name(msg::TypeOf<T>())).starts_with("rtd_msgs/");
    });
    EXPECT_EQ(topic.name.rfind("rt/", 0) == 0, !own_type) << topic.name;
  }
}

TEST(Topics, every_message_type_is_reachable_by_its_id) {
  for (const TopicFacts& topic : all_topics()) {
    const MessageId visited = visit_message_type(topic.type, []<class T>() { return MessageTraits<T>::kId; });
    EXPECT_EQ(visited, topic.type) << topic.name;
  }
  EXPECT_THROW(visit_message_type(static_cast<MessageId>(200), []<class T>() {}), BusError);
}

TEST(QosProfiles, only_the_raw_frame_shares_the_writers_memory) {
  for (const TopicFacts& topic : all_topics()) {
    const QosSettings settings = qos_settings(topic.profile);
    const auto is_frame = [&](const FrameTopic& frames) { return frames.type == topic.type; };
    EXPECT_EQ(settings.data_sharing, std::ranges::any_of(frame_topics(), is_frame)) << topic.name;
    EXPECT_TRUE(topic.plain || !settings.data_sharing) << topic.name;
    EXPECT_GE(settings.depth, 1) << topic.name;
  }
}

TEST(QosProfiles, what_late_readers_need_is_kept_for_them) {
  EXPECT_TRUE(qos_settings(topics::kKeyframes.profile).transient_local);
  EXPECT_TRUE(qos_settings(topics::kCameraInfo.profile).transient_local);
  EXPECT_TRUE(qos_settings(topics::kMapPoints.profile).transient_local);
  EXPECT_FALSE(qos_settings(topics::kFrame.profile).transient_local);
}

TEST(QosProfiles, an_unknown_profile_number_is_refused) {
  EXPECT_THROW(qos_settings(static_cast<QosProfile>(200)), BusError);
}

TEST(QosProfiles, match_themselves_and_name_what_a_reader_asks_too_much) {
  for (const TopicFacts& topic : all_topics()) {
    const QosSettings settings = qos_settings(topic.profile);
    EXPECT_EQ(incompatible_policy(settings, settings), "") << topic.name;
  }
  const QosSettings pose = qos_settings(QosProfile::kPose), latched = qos_settings(QosProfile::kLatched);
  const QosSettings heartbeat = qos_settings(QosProfile::kHeartbeat);
  EXPECT_EQ(incompatible_policy(pose, latched), "DURABILITY");
  EXPECT_EQ(incompatible_policy(latched, pose), "");
  EXPECT_EQ(incompatible_policy(pose, heartbeat), "LIVELINESS");
  QosSettings no_deadline = heartbeat;
  no_deadline.deadline_ms = 0;
  EXPECT_EQ(incompatible_policy(no_deadline, heartbeat), "DEADLINE");
}

}  // namespace
}  // namespace rtd::bus
