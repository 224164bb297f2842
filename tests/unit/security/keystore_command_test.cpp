// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/keystore/keystore_command.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <sstream>

#include "common/bus/topic_roles.hpp"
#include "common/security/enclave.hpp"
#include "tests/unit/security/sample_keystore.hpp"

namespace rtd::keystore {
namespace {

using Action = KeystoreRequest::Action;
using security::kDay_s;
using security::kNow_s;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class KeystoreCommandTest : public security::KeystoreTest {
 protected:
  KeystoreCommandTest() { request_.folder = (scratch_ / "k").string(); }
  int run(Action action, std::int64_t now_s = kNow_s) {
    request_.action = action;
    out_.str("");
    err_.str("");
    return run_keystore(request_, now_s, out_, err_);
  }
  KeystoreRequest request_;
  std::ostringstream out_, err_;
};

TEST_F(KeystoreCommandTest, makes_an_enclave_for_each_role_with_the_topics_of_the_table) {
  request_.days = 30;
  request_.domain = 5;
  ASSERT_EQ(run(Action::kCreate), 0) << err_.str();
  for (const std::string& role : bus::roles()) {
    const auto enclave = security::open_enclave(request_.folder, "/rtd/" + role, 5, kNow_s + 29 * kDay_s);
    EXPECT_EQ(enclave.permissions.topics.publish, bus::topics_of(role).writes) << role;
    EXPECT_EQ(enclave.permissions.topics.subscribe, bus::topics_of(role).reads) << role;
  }
}

TEST_F(KeystoreCommandTest, a_second_one_is_refused) {
  ASSERT_EQ(run(Action::kCreate), 0);
  EXPECT_EQ(run(Action::kCreate), 2);
  EXPECT_THAT(err_.str(), HasSubstr("exists already"));
}

TEST_F(KeystoreCommandTest, info_names_what_expired_and_renew_fixes_it) {
  ASSERT_EQ(run(Action::kCreate), 0);
  EXPECT_EQ(run(Action::kInfo), 0);
  EXPECT_THAT(out_.str(), AllOf(HasSubstr("ok    /rtd/slam"), HasSubstr("all domains"), HasSubstr(" topics out ")));
  EXPECT_THAT(out_.str(), Not(HasSubstr("rtd/features"))) << "with --verbose";
  request_.verbose = true;
  EXPECT_EQ(run(Action::kInfo), 0);
  EXPECT_THAT(out_.str(), HasSubstr("rtd/features"));
  const std::int64_t later_s = kNow_s + 400 * kDay_s;
  EXPECT_EQ(run(Action::kInfo, later_s), 1);
  EXPECT_THAT(out_.str(), AllOf(HasSubstr("FAIL  /rtd/slam"), HasSubstr("expired")));
  EXPECT_EQ(run(Action::kRenew, later_s), 0) << err_.str();
  EXPECT_EQ(run(Action::kInfo, later_s), 0) << out_.str();
}

TEST_F(KeystoreCommandTest, adds_an_enclave_like_another_with_further_topics) {
  ASSERT_EQ(run(Action::kCreate), 0);
  request_.enclaves = {"/rtd/observer2"};
  request_.like = "observer";
  request_.subscribe = {"rtd/features"};
  ASSERT_EQ(run(Action::kAdd), 0) << err_.str();
  const auto added = security::open_enclave(request_.folder, "/rtd/observer2", 0, kNow_s);
  EXPECT_TRUE(security::matches_any(added.permissions.topics.subscribe, "rt/slam/pose"));
  EXPECT_TRUE(security::matches_any(added.permissions.topics.subscribe, "rtd/features"));
  EXPECT_FALSE(security::matches_any(added.permissions.topics.publish, "rt/slam/pose"));
}

TEST_F(KeystoreCommandTest, robots_have_enclaves_of_their_own_and_share_detector_and_atlas) {
  const auto grant = [this](const std::string& name) {
    return security::open_enclave(request_.folder, name, 0, kNow_s).permissions.topics;
  };
  request_.robots = {"anna"};
  ASSERT_EQ(run(Action::kCreate), 0) << err_.str();
  request_.robots = {"bert"};
  ASSERT_EQ(run(Action::kAdd), 0) << err_.str();
  for (const std::string robot : {"anna", "bert"}) {
    const std::string jpegs = "rt/" + robot + "/camera/color/image_raw/compressed";
    EXPECT_TRUE(security::matches_any(grant("/rtd/" + robot + "/camera").publish, jpegs));
    EXPECT_TRUE(security::matches_any(grant("/rtd/" + robot + "/camera").publish, "rtd/" + robot + "/frame"));
    EXPECT_TRUE(security::matches_any(grant("/rtd/detector").subscribe, jpegs));
    EXPECT_TRUE(security::matches_any(grant("/rtd/detector").publish, "rt/" + robot + "/detector/detections"));
    EXPECT_TRUE(security::matches_any(grant("/rtd/atlas").subscribe, "rtd/" + robot + "/map"));
    EXPECT_TRUE(security::matches_any(grant("/rtd/atlas").subscribe, "rtd/" + robot + "/keyframe_features"));
    EXPECT_TRUE(security::matches_any(grant("/rtd/atlas").publish, "rtd/" + robot + "/submap"));
    EXPECT_TRUE(security::matches_any(grant("/rtd/" + robot + "/slam").publish, "rtd/" + robot + "/keyframe_features"));
    EXPECT_TRUE(security::matches_any(grant("/rtd/" + robot + "/slam").subscribe, "rtd/" + robot + "/submap"));
    for (const std::string topic : {"/keyframe_features", "/map"})
      EXPECT_FALSE(security::matches_any(grant("/rtd/" + robot + "/camera").publish, "rtd/" + robot + topic));
  }
  EXPECT_FALSE(security::matches_any(grant("/rtd/anna/slam").publish, "rtd/bert/keyframe_features"));
  EXPECT_FALSE(security::matches_any(grant("/rtd/anna/slam").publish, "rt/bert/slam/pose"));
  EXPECT_FALSE(security::matches_any(grant("/rtd/anna/slam").publish, "rt/slam/pose"));
  EXPECT_TRUE(security::matches_any(grant("/rtd/detector").publish, "rt/detector/detections")) << "and it alone";
  request_.robots = {"b/c"};
  EXPECT_EQ(run(Action::kAdd), 2);
  EXPECT_THAT(err_.str(), HasSubstr("b/c cannot be a robot's name"));
}

TEST_F(KeystoreCommandTest, a_robot_added_to_a_keystore_without_an_atlas_brings_its_enclave) {
  ASSERT_EQ(run(Action::kCreate), 0) << err_.str();
  std::filesystem::remove_all(std::filesystem::path(request_.folder) / "enclaves/rtd/atlas");
  request_.robots = {"anna"};
  ASSERT_EQ(run(Action::kAdd), 0) << err_.str();
  const auto atlas = security::open_enclave(request_.folder, "/rtd/atlas", 0, kNow_s).permissions.topics;
  EXPECT_TRUE(security::matches_any(atlas.publish, "rtd/atlas"));
  EXPECT_TRUE(security::matches_any(atlas.subscribe, "rtd/anna/keyframe_features"));
}

TEST_F(KeystoreCommandTest, info_of_no_keystore_says_how_to_make_one) {
  EXPECT_EQ(run(Action::kInfo), 2);
  EXPECT_THAT(err_.str(), HasSubstr("rtd keystore create"));
}

}  // namespace
}  // namespace rtd::keystore
