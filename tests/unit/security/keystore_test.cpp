// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <sstream>

#include "common/bus/topic_roles.hpp"
#include "common/security/enclave.hpp"
#include "common/security/keystore.hpp"
#include "services/keystore/keystore_command.hpp"
#include "tests/support/run_command.hpp"
#include "tests/unit/security/sample_keystore.hpp"

namespace rtd::security {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST_F(KeystoreTest, has_the_layout_of_sros2) {
  const fs::path keystore = create("k");
  for (const char* file : {"public/ca.cert.pem", "public/identity_ca.cert.pem", "public/permissions_ca.cert.pem",
                           "private/ca.key.pem", "private/identity_ca.key.pem", "private/permissions_ca.key.pem",
                           "enclaves/governance.xml", "enclaves/governance.p7s", "enclaves/a/identity_ca.cert.pem",
                           "enclaves/a/permissions_ca.cert.pem", "enclaves/a/cert.pem", "enclaves/a/key.pem",
                           "enclaves/a/governance.p7s", "enclaves/a/permissions.xml", "enclaves/a/permissions.p7s"}) {
    EXPECT_TRUE(fs::is_regular_file(keystore / file)) << file;
  }
}

TEST_F(KeystoreTest, private_keys_are_for_their_owner_only) {
  const fs::path keystore = create("k");
  const fs::perms owner = fs::perms::owner_read | fs::perms::owner_write;
  EXPECT_EQ(fs::status(keystore / "private/ca.key.pem").permissions(), owner);
  EXPECT_EQ(fs::status(keystore / "enclaves/a/key.pem").permissions(), owner);
  EXPECT_EQ(fs::status(keystore / "private").permissions(), fs::perms::owner_all);
}

TEST_F(KeystoreTest, nothing_is_overwritten) {
  const std::string keystore = create("k");
  const std::string key = read_text(keystore + "/private/ca.key.pem");
  EXPECT_THAT(error_of([&] { create_keystore(keystore, {}); }), HasSubstr("exists already"));
  EXPECT_THAT(error_of([&] { add_enclaves(keystore, {{"/a", {}}}, {}, {}); }), HasSubstr("/a exists already"));
  EXPECT_EQ(read_text(keystore + "/private/ca.key.pem"), key);
}

TEST_F(KeystoreTest, openssl_itself_accepts_certificates_and_signatures) {
  const std::string k = create("k"), ca = k + "/public/ca.cert.pem", at = " -attime " + std::to_string(kNow_s);
  if (rtd::testing::run_command("command -v openssl").exit_code != 0) GTEST_SKIP() << "openssl(1) is not installed";
  EXPECT_EQ(
      rtd::testing::run_command("openssl verify" + at + " -CAfile " + ca + " " + k + "/enclaves/a/cert.pem").exit_code,
      0);
  const std::string verify = "openssl smime -verify -text" + at + " -CAfile " + ca + " -in " + k;
  const auto permissions = rtd::testing::run_command(verify + "/enclaves/a/permissions.p7s");
  EXPECT_EQ(permissions.exit_code, 0) << permissions.output;
  EXPECT_THAT(permissions.output, HasSubstr("<subject_name>CN=/a</subject_name>"));
  EXPECT_EQ(rtd::testing::run_command(verify + "/enclaves/governance.p7s").exit_code, 0);
}

TEST_F(KeystoreTest, renewing_gives_new_keys_and_dates_and_keeps_the_topics) {
  const std::string keystore = create("k", {3, 3}), key = read_text(keystore + "/enclaves/a/key.pem");
  renew_enclave(keystore, "/a", {kNow_s, kNow_s + 99 * kDay_s}, {{}, {"u"}});
  const Enclave enclave = open_enclave(keystore, "/a", 3, kNow_s + 90 * kDay_s);
  EXPECT_THAT(enclave.permissions.topics.publish, ElementsAre("t"));
  EXPECT_THAT(enclave.permissions.topics.subscribe, ElementsAre("u"));
  EXPECT_NE(read_text(keystore + "/enclaves/a/key.pem"), key);
}

TEST_F(KeystoreTest, without_the_cas_key_nothing_is_added_or_renewed) {
  const std::string keystore = create("k");
  fs::remove_all(keystore + "/private");
  EXPECT_THAT(error_of([&] { add_enclaves(keystore, {{"/c", {}}}, {}, {}); }), HasSubstr("ca.key.pem is missing"));
  EXPECT_THAT(error_of([&] { renew_enclave(keystore, "/a", {}, {}); }), HasSubstr("ca.key.pem is missing"));
}

TEST_F(KeystoreTest, names_that_leave_the_keystore_are_refused) {
  const std::string keystore = create("k");
  for (const char* name : {"", "a", "/", "/../x", "/a b", "/x/", "//x"})
    EXPECT_THAT(error_of([&] { add_enclaves(keystore, {{name, {}}}, {}, {}); }), HasSubstr("begin with '/'")) << name;
}

}  // namespace
}  // namespace rtd::security

namespace rtd::keystore {
namespace {

using Action = KeystoreRequest::Action;
using security::kDay_s;
using security::kNow_s;
using namespace ::testing;

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

TEST_F(KeystoreCommandTest, the_viewer_of_a_robot_may_see_where_all_robots_are_and_no_more_of_them) {
  request_.robots = {"anna", "bert"};
  ASSERT_EQ(run(Action::kCreate), 0) << err_.str();
  const auto viewer = security::open_enclave(request_.folder, "/rtd/anna/viewer", 0, kNow_s);
  const auto may_read = [&](const char* topic) {
    return security::matches_any(viewer.permissions.topics.subscribe, topic);
  };
  EXPECT_TRUE(may_read("rtd/atlas"));
  EXPECT_TRUE(may_read("rtd/anna/map"));
  EXPECT_FALSE(may_read("rtd/bert/map"));
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
