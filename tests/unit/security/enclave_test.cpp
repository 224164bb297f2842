// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/security/enclave.hpp"

#include <gmock/gmock.h>

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

TEST_F(EnclaveTest, a_missing_enclave_names_the_existing_ones) {
  EXPECT_THAT(refusal(create("k"), "/c"), AllOf(HasSubstr("no enclave /c, only /a /b"), HasSubstr("rtd keystore add")));
}

TEST_F(EnclaveTest, names_the_file_that_is_missing) {
  const std::string keystore = create("k");
  fs::remove(keystore + "/enclaves/a/key.pem");
  EXPECT_THAT(refusal(keystore), AllOf(HasSubstr("a/key.pem"), HasSubstr("No such file")));
}

TEST_F(EnclaveTest, expired_names_the_day_and_the_fix) {
  EXPECT_THAT(refusal(create("k"), "/a", 0, kNow_s + 6 * kDay_s),
              AllOf(HasSubstr("expired on 2027-01-20T08:00:00"), HasSubstr("rtd keystore renew")));
}

TEST_F(EnclaveTest, not_valid_yet_asks_for_the_clock) {
  EXPECT_THAT(refusal(create("k"), "/a", 0, kNow_s - 6 * kDay_s), HasSubstr("clock"));
}

TEST_F(EnclaveTest, another_domain_is_refused) {
  EXPECT_THAT(refusal(create("k", {3, 3}), "/a", 4), HasSubstr("may join domains 3..3, not 4"));
}

TEST_F(EnclaveTest, a_certificate_of_another_ca_is_refused) {
  const std::string keystore = create("k"), rogue = create("rogue");
  replace(rogue + "/enclaves/a/cert.pem", keystore + "/enclaves/a/cert.pem");
  EXPECT_THAT(refusal(keystore), HasSubstr("not issued by the CA"));
}

TEST_F(EnclaveTest, a_key_that_is_not_the_certificates_is_refused) {
  const std::string keystore = create("k");
  replace(keystore + "/enclaves/b/key.pem", keystore + "/enclaves/a/key.pem");
  EXPECT_THAT(refusal(keystore), HasSubstr("is not the key of"));
}

TEST_F(EnclaveTest, permissions_of_another_enclave_are_refused) {
  const std::string keystore = create("k");
  replace(keystore + "/enclaves/b/permissions.p7s", keystore + "/enclaves/a/permissions.p7s");
  EXPECT_THAT(refusal(keystore), HasSubstr("is for CN=/b, the certificate next to it for CN=/a"));
}

TEST_F(EnclaveTest, edited_permissions_are_refused) {
  const std::string keystore = create("k"), file = keystore + "/enclaves/a/permissions.p7s";
  std::string text = read_text(file);
  text.replace(text.find("<topic>t<"), 9, "<topic>*<");
  std::ofstream(file) << text;
  EXPECT_THAT(refusal(keystore), HasSubstr("is not signed by CN=rtdCA"));
}

TEST_F(EnclaveTest, a_governance_that_another_ca_signed_is_refused) {
  const std::string keystore = create("k"), rogue = create("rogue");
  replace(rogue + "/enclaves/governance.p7s", keystore + "/enclaves/governance.p7s");
  EXPECT_THAT(refusal(keystore), AllOf(HasSubstr("governance.p7s"), HasSubstr("not signed by")));
}

}  // namespace
}  // namespace rtd::security
