// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Lines as Cyclone DDS 0.10.2 wrote them.
#include <gmock/gmock.h>

#include "common/bus/cyclonedds/unmatched_participants.hpp"

namespace rtd::bus::cyclonedds {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::StartsWith;

const std::string kCyclone =
    "NEW (0x00000000-0x0000002c-0x00000000-0x00000000-0x00000000 vm/0.10.2/Linux/Linux) (data udp/127.0.0.1:41407@1 "
    "meta udp/127.0.0.1:41407@1) QOS={property_list={}:{},entity_name=\"";
const std::string kFast =
    "NEW (data udp/127.0.0.1:17691@1 meta udp/127.0.0.1:17690@1) QOS={property_list={1:\"fastdds.physical_data.host\":"
    "\"vm\"}:{},entity_name=\"";
const std::string kClear = "SPDP ST0 1108578:27b0c492:b43f7df5:1c1 bes fc3f " + kCyclone + "clear\"}\n";
const std::string kRogue = "SPDP ST0 f6933eb0:6a834ff7:832f23f8:1c1 bes ffffc3f (secure) " + kCyclone + "rogue\"}\n";
const std::string kGood = "SPDP ST0 a2d1b1ca:8a511908:d27c8514:1c1 bes ffffc3f (secure) " + kCyclone + "good\"}\n";
const std::string kProven =
    "handshake (lguid=f6933eb0:6a8346b9:88f5f278:1c1 rguid=a2d1b1ca:8a511908:d27c8514:1c1) processed\n";
const std::string kFailed =
    "Begin handshake reply failed: Certificate not valid: error: certificate signature failure; subject: "
    "/CN=\\/rtd\\/writer(code: 200)\n";

class UnmatchedParticipantsTest : public ::testing::Test {
 protected:
  std::vector<std::string> read(const std::string& line) { return unmatched_.read(line, now_); }
  UnmatchedParticipants unmatched_{7};
  UnmatchedParticipants::TimePoint now_{};
};

TEST_F(UnmatchedParticipantsTest, a_participant_without_certificate_is_named_once) {
  EXPECT_THAT(read(kClear), ElementsAre(StartsWith("participant 'clear' 01.10.85.78.27.b0.c4.92.b4.3f.7d.f5 in secured "
                                                   "domain 7 has no certificate")));
  EXPECT_THAT(read(kClear), IsEmpty());
  EXPECT_THAT(read("SPDP ST0 1108578:27b0c492:b43f7df5:1c1 (update)ddsi_update_qos_locked\n"), IsEmpty());
}

TEST_F(UnmatchedParticipantsTest, another_vendor_is_named_by_its_name) {
  EXPECT_THAT(
      read("SPDP ST0 a2d1b1ca:8a5185f1:7c76248d:1c1 bes fff0c3f (secure) " + kFast + "rtd-slam\"}\n"),
      ElementsAre(StartsWith("participant 'rtd-slam' a2.d1.b1.ca.8a.51.85.f1.7c.76.24.8d in secured domain 7 runs "
                             "Fast DDS")));
}

TEST_F(UnmatchedParticipantsTest, a_participant_that_fails_the_handshake_is_named_once) {
  EXPECT_THAT(read(kRogue), IsEmpty());
  EXPECT_THAT(read(kFailed), ElementsAre(StartsWith("participant 'rogue' f6.93.")));
  EXPECT_THAT(read(kFailed), IsEmpty());
}

TEST_F(UnmatchedParticipantsTest, no_participant_is_named_in_place_of_another) {
  read(kRogue);
  read(kGood);
  EXPECT_THAT(read(kFailed), IsEmpty()) << "it is one of two";
  read(kProven);
  EXPECT_THAT(read(kFailed), ElementsAre(StartsWith("participant 'rogue'")));
}

TEST_F(UnmatchedParticipantsTest, of_several_participants_the_long_unproven_ones_are_named) {
  read(kRogue);
  now_ += 4s;
  read(kGood);
  EXPECT_THAT(read(kFailed), ElementsAre(StartsWith("participant 'rogue'")));
}

TEST_F(UnmatchedParticipantsTest, a_participant_that_has_gone_is_forgotten) {
  read(kRogue);
  read("ddsi_delete_proxy_participant_by_guid(f6933eb0:6a834ff7:832f23f8:1c1) - deleting\n");
  EXPECT_THAT(read(kFailed), IsEmpty());
  read(kClear);
  read("SPDP ST3 1108578:27b0c492:b43f7df5:1c1ddsi_delete_proxy_participant_by_guid(");
  EXPECT_THAT(read(kClear), ElementsAre(StartsWith("participant 'clear'")));
}

TEST_F(UnmatchedParticipantsTest, malformed_lines_do_no_harm) {
  for (const char* line : {"", "SPDP ST0 ", "SPDP ST0 x NEW ", "SPDP ST3", "handshake (lguid=", " failed: ", "NEW (0x"})
    read(line);
  EXPECT_THAT(read("SPDP ST0 1:2:3:1c1 bes f NEW (0x0) QOS={entity_name=\"a\nevent=b\"}"),
              ElementsAre(StartsWith("participant 'a?event=b' 00.00.00.01.")));
}

}  // namespace
}  // namespace rtd::bus::cyclonedds
