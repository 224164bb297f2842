// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <fstream>

#include "common/bus/topic_roles.hpp"
#include "common/security/enclave.hpp"
#include "common/security/permissions.hpp"
#include "tests/unit/security/sample_keystore.hpp"

namespace rtd::security {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class EnclaveTest : public KeystoreTest {
 protected:
  std::string refusal(const std::string& keystore, const std::string& name = "/a", int domain = 0,
                      std::int64_t now_s = kNow_s) const {
    return error_of([&] { open_enclave(keystore, name, domain, now_s); });
  }
  static void replace(const std::string& with, const std::string& file) {
    fs::remove(file);
    fs::copy_file(with, file);
  }
};

TEST_F(EnclaveTest, opens_what_was_made) {
  const Enclave enclave = open_enclave(create("k"), "/a", 7, kNow_s);
  EXPECT_EQ(enclave.permissions.subject, "CN=/a");
  EXPECT_THAT(enclave.permissions.topics.publish, ElementsAre("t"));
  EXPECT_EQ(enclave.valid_until_s(), kNow_s + 5 * kDay_s);
}

TEST_F(EnclaveTest, says_that_there_is_no_keystore) {
  EXPECT_THAT(refusal((scratch_ / "none").string()),
              AllOf(HasSubstr("there is none"), HasSubstr("rtd keystore create")));
}

TEST_F(EnclaveTest, names_the_file_that_is_missing) {
  const std::string keystore = create("k");
  fs::remove(keystore + "/enclaves/a/key.pem");
  EXPECT_THAT(refusal(keystore), AllOf(HasSubstr("a/key.pem"), HasSubstr("No such file")));
}

TEST_F(EnclaveTest, other_times_domains_and_names_are_refused_with_the_fix) {
  const std::string keystore = create("k", {3, 3});
  EXPECT_THAT(refusal(keystore, "/a", 3, kNow_s + 6 * kDay_s),
              AllOf(HasSubstr("expired on 2027-01-20T08:00:00"), HasSubstr("rtd keystore renew")));
  EXPECT_THAT(refusal(keystore, "/a", 3, kNow_s - 6 * kDay_s), HasSubstr("clock"));
  EXPECT_THAT(refusal(keystore, "/a", 4), HasSubstr("may join domains 3..3, not 4"));
  EXPECT_THAT(refusal(keystore, "/c", 3), AllOf(HasSubstr("no enclave /c, only /a /b"), HasSubstr("rtd keystore add")));
}

/// A file of the keystore, what takes its place, and the words of the refusal.
TEST_F(EnclaveTest, files_of_others_are_refused) {
  using Row = std::array<std::string, 3>;
  for (const auto& [file, other, words] :
       {Row{"enclaves/a/cert.pem", "rogue/enclaves/a/cert.pem", "not issued by the CA"},
        Row{"enclaves/a/key.pem", "k/enclaves/b/key.pem", "is not the key of"},
        Row{"enclaves/a/permissions.p7s", "k/enclaves/b/permissions.p7s",
            "is for CN=/b, the certificate next to it for CN=/a"},
        Row{"enclaves/governance.p7s", "rogue/enclaves/governance.p7s", "not signed by"}}) {
    for (const char* name : {"k", "rogue"}) fs::remove_all(scratch_ / name);
    const std::string keystore = create("k");
    create("rogue");
    replace((scratch_ / other).string(), keystore + "/" + file);
    EXPECT_THAT(refusal(keystore), HasSubstr(words)) << file;
    if (file.ends_with("governance.p7s")) {
      EXPECT_THAT(refusal(keystore), HasSubstr("governance.p7s"));
    }
  }
}

TEST_F(EnclaveTest, edited_permissions_are_refused) {
  const std::string keystore = create("k"), file = keystore + "/enclaves/a/permissions.p7s";
  std::string text = read_text(file);
  text.replace(text.find("<topic>t<"), 9, "<topic>*<");
  std::ofstream(file) << text;
  EXPECT_THAT(refusal(keystore), HasSubstr("is not signed by CN=rtdCA"));
}

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
