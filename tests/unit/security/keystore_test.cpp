// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/security/keystore.hpp"

#include <gmock/gmock.h>

#include "common/security/enclave.hpp"
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
  EXPECT_EQ(rtd::testing::run_command("openssl verify" + at + " -CAfile " + ca + " " + k + "/enclaves/a/cert.pem").exit_code,
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
