// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstdint>
#include <vector>

#include "common/bus/backend.hpp"
#include "common/bus/cyclonedds/domain_config.hpp"
#include "common/bus/cyclonedds/endpoints.hpp"
#include "common/bus/cyclonedds/unmatched_participants.hpp"

namespace rtd::bus::cyclonedds {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::StartsWith;

const HostLimits kLimits{0, 0, 4'194'304, 212'992};

TEST(CycloneConfig, keeps_to_loopback_with_multicast_for_discovery_only) {
  EXPECT_THAT(domain_config({}, kLimits),
              AllOf(HasSubstr(R"(<NetworkInterface address="127.0.0.1" multicast="true" priority="10"/></Interfaces>)"),
                    Not(HasSubstr("MulticastTimeToLive")), HasSubstr("<AllowMulticast>spdp</AllowMulticast>"),
                    HasSubstr(R"(<Peers><Peer address="127.0.0.1"/></Peers>)"), Not(HasSubstr("SharedMemory"))));
}

TEST(CycloneConfig, sends_no_multicast_into_a_network_that_only_this_host_uses) {
  EXPECT_THAT(
      domain_config({}, kLimits, DiscoveryPort::kOfPeers, {"192.0.2.7", "192.0.2.8", "192.0.2.9", "192.0.2.10"}),
      AllOf(HasSubstr(R"(<NetworkInterface address="127.0.0.1" multicast="true" priority="10"/>)"),
            HasSubstr(R"(<NetworkInterface address="192.0.2.7" multicast="default"/>)"),
            HasSubstr(R"(<NetworkInterface address="192.0.2.9" multicast="default"/></Interfaces>)"),
            HasSubstr("<MulticastTimeToLive>0</MulticastTimeToLive>"),
            HasSubstr("<MulticastRecvNetworkInterfaceAddresses>127.0.0.1</")));
}

TEST(CycloneConfig, takes_a_port_that_peers_ask_or_any) {
  EXPECT_THAT(domain_config({}, kLimits), HasSubstr("<ParticipantIndex>auto</ParticipantIndex>"));
  EXPECT_THAT(domain_config({}, kLimits, DiscoveryPort::kAny), HasSubstr("<ParticipantIndex>none</ParticipantIndex>"));
}

TEST(CycloneConfig, asks_for_no_more_buffer_than_the_kernel_grants) {
  EXPECT_THAT(domain_config({}, kLimits),
              AllOf(HasSubstr(R"(<SocketReceiveBufferSize min="default" max="4194304 B"/>)"),
                    HasSubstr(R"(<SocketSendBufferSize min="default" max="212992 B"/>)")));
}

TEST(CycloneConfig, cuts_samples_so_that_datagrams_stay_whole) {
  BusOptions options;
  options.network.max_datagram_bytes = 1400;
  EXPECT_THAT(domain_config(options, kLimits), AllOf(HasSubstr("<MaxMessageSize>1400 B</MaxMessageSize>"),
                                                     HasSubstr("<FragmentSize>1240 B</FragmentSize>")));
  options.security = {"/keys", "/rtd/slam"};  // its headers need room, too
  EXPECT_THAT(domain_config(options, kLimits), HasSubstr("<FragmentSize>1040 B</FragmentSize>"));
}

TEST(CycloneConfig, asks_peers_at_the_ports_that_ours_take) {
  BusOptions options;
  options.network.multicast = false;
  options.network.peers = {"127.0.0.1:7410", "127.0.0.2"};
  EXPECT_THAT(
      domain_config(options, kLimits),
      AllOf(HasSubstr("<AllowMulticast>false</AllowMulticast>"), HasSubstr(R"(<Peer address="127.0.0.1:7410"/>)"),
            HasSubstr(R"(<Peer address="127.0.0.2"/>)"), HasSubstr("<ParticipantIndex>auto</ParticipantIndex>")));
}

TEST(CycloneConfig, refuses_a_peer_that_is_not_a_host) {
  BusOptions options;
  options.network.peers = {"\"/><Peer address=\"192.0.2.1"};
  EXPECT_THROW(domain_config(options, kLimits), BusError);
}

constexpr std::size_t kKindAt = 20, kBodyAt = kKindAt + 4, kSizeAt = kKindAt + 32;
constexpr std::uint8_t kDataFrag = 0x16, kPad = 0x01;
const WriterId kWriter = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 5, 6, 7};

/// One fragment of 8 bytes of a sample of 100.
std::vector<std::uint8_t> datagram(std::uint8_t fragment) {
  const std::vector<std::uint8_t> body = {0,        0, 28, 0, 0, 0, 0, 0, 4,   5, 6, 7, 0, 0, 0, 0, 9, 0, 0, 0,
                                          fragment, 0, 0,  0, 1, 0, 8, 0, 100, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8};
  std::vector<std::uint8_t> all = {'R', 'T', 'P', 'S', 2, 3, 1, 16};
  all.resize(kBodyAt);
  all[kKindAt] = kDataFrag;
  all[kKindAt + 1] = 1;
  all[kKindAt + 2] = static_cast<std::uint8_t>(body.size());
  all.insert(all.end(), body.begin(), body.end());
  return all;
}

std::vector<std::uint8_t> marked(const SampleLimits& limits, std::uint8_t fragment) {
  auto bytes = datagram(fragment);
  limits.mark_too_large(std::as_writable_bytes(std::span(bytes)));
  return bytes;
}

TEST(SampleLimits, make_the_first_fragment_of_a_too_large_sample_huge_and_the_others_padding) {
  SampleLimits limits;
  limits.note(&limits, {kWriter}, 99);
  const auto first = marked(limits, 1), second = marked(limits, 2);
  EXPECT_EQ(first[kKindAt], kDataFrag);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(first[kSizeAt + i], 0xff);
  EXPECT_EQ(second[kKindAt], kPad);
}

TEST(SampleLimits, leave_alone_what_a_reader_takes_and_writers_of_none) {
  SampleLimits limits;
  EXPECT_EQ(marked(limits, 1), datagram(1));
  limits.note(&limits, {kWriter}, 100);
  EXPECT_EQ(marked(limits, 2), datagram(2));
  const int another_reader = 0;
  limits.note(&another_reader, {kWriter}, 10);
  EXPECT_EQ(limits.of(kWriter), 100U);
  limits.note(&limits, {}, 100);
  EXPECT_EQ(limits.of(kWriter), 10U);
  limits.note(&another_reader, {}, 10);
  EXPECT_EQ(limits.of(kWriter), std::nullopt);
}

// Lines as Cyclone DDS 0.10.2 wrote them.

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
