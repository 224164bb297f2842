// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "common/bus/backend.hpp"
#include "common/bus/cyclonedds/domain_config.hpp"

namespace rtd::bus::cyclonedds {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

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

}  // namespace
}  // namespace rtd::bus::cyclonedds
