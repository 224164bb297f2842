// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/security/permissions.hpp"

#include <gmock/gmock.h>

#include "common/bus/topic_roles.hpp"

namespace rtd::security {
namespace {

using ::testing::HasSubstr;

TEST(PermissionsTest, survive_xml) {
  const Permissions written{"CN=/rtd/slam", {1'000'000'000, 2'000'000'000}, {4, 9}, {{"rt/tf", "rt/a/*"}, {"rtd/b"}}};
  const Permissions read = permissions_from_xml(to_xml(written), "test");
  EXPECT_EQ(read.subject, written.subject);
  EXPECT_EQ(read.validity.not_before_s, written.validity.not_before_s);
  EXPECT_EQ(read.validity.not_after_s, written.validity.not_after_s);
  EXPECT_EQ(read.domains.first, 4);
  EXPECT_EQ(read.domains.last, 9);
  EXPECT_EQ(read.topics.publish, written.topics.publish);
  EXPECT_EQ(read.topics.subscribe, written.topics.subscribe);
}

TEST(PermissionsTest, what_is_not_a_permissions_document_is_refused_with_its_name) {
  for (const char* xml : {"", "<dds", "<dds/>", "<dds><permissions><grant/></permissions></dds>"}) {
    try {
      permissions_from_xml(xml, "file.xml");
      ADD_FAILURE() << xml;
    } catch (const SecurityError& error) {
      EXPECT_THAT(error.what(), HasSubstr("file.xml"));
    }
  }
}

TEST(PermissionsTest, roles_may_do_what_they_need_and_no_more) {
  const auto may = [](const char* role, const char* topic) {
    const bus::RoleTopics topics = bus::topics_of(role);
    return std::pair(matches_any(topics.writes, topic), matches_any(topics.reads, topic));
  };
  EXPECT_EQ(may("camera", "rtd/frame"), std::pair(true, false));
  EXPECT_EQ(may("slam", "rtd/frame"), std::pair(false, false));
  EXPECT_EQ(may("slam", "rt/slam/odometry"), std::pair(true, false));
  EXPECT_EQ(may("observer", "rt/slam/odometry"), std::pair(false, true));
  EXPECT_EQ(may("observer", "rtd/frame"), std::pair(false, false));
  EXPECT_EQ(may("launcher", "rtd/status"), std::pair(false, true));
  EXPECT_EQ(may("record", "rt/anything"), std::pair(false, true));
  EXPECT_EQ(may("atlas", "rtd/keyframe_features"), std::pair(false, true));
  EXPECT_EQ(may("atlas", "rtd/map"), std::pair(false, true)) << "it cannot speak for a robot";
  EXPECT_EQ(may("slam", "rtd/submap"), std::pair(false, true)) << "nor a robot for the atlas";
  EXPECT_EQ(may("observer", "rtd/atlas"), std::pair(false, true));
  for (const char* caller : {"call", "viewer"}) {
    EXPECT_EQ(may(caller, "rq/recorder/stopRequest"), std::pair(true, false)) << caller;
    EXPECT_EQ(may(caller, "rr/recorder/stopReply"), std::pair(false, true)) << caller;
  }
  EXPECT_EQ(may("record", "rq/recorder/stopRequest"), std::pair(false, true));
  EXPECT_EQ(may("record", "rr/recorder/stopReply"), std::pair(true, false));
  for (const char* topic : {"rq/recorder/stopRequest", "rr/recorder/stopReply"})
    EXPECT_EQ(may("observer", topic), std::pair(false, false)) << "neither calls nor answers in another's name";
  EXPECT_EQ(may("observer", "rq/my_node/get_parametersRequest"), std::pair(false, true));
}

TEST(PermissionsTest, only_the_frames_are_not_encrypted) {
  const std::string xml = to_xml(Governance{{}, {"rtd/frame"}});
  EXPECT_LT(xml.find("<topic_expression>rtd/frame<"), xml.find("<topic_expression>*<"));
  EXPECT_LT(xml.find("<data_protection_kind>NONE"), xml.find("<data_protection_kind>ENCRYPT"));
  EXPECT_THAT(xml, HasSubstr("<allow_unauthenticated_participants>false<"));
}

}  // namespace
}  // namespace rtd::security
