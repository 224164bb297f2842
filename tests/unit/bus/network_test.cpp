// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/network.hpp"

#include <gmock/gmock.h>

#include "common/bus/backend.hpp"
#include "common/bus/frame_topics.hpp"
#include "common/bus/topics.hpp"

namespace rtd::bus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// What() of the BusError that `call` throws; empty when it throws none.
template <class Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const BusError& error) {
    return error.what();
  }
  return {};
}

BusOptions with_peers(std::vector<std::string> peers) {
  BusOptions options;
  options.network.peers = std::move(peers);
  return options;
}

TEST(Network, a_host_is_an_address_or_a_name_with_or_without_port) {
  EXPECT_EQ(resolve_host("10.0.0.2", "--peers"), (HostAddress{"10.0.0.2", 0}));
  EXPECT_EQ(resolve_host("10.0.0.2:7412", "--peers"), (HostAddress{"10.0.0.2", 7412}));
  EXPECT_EQ(resolve_host("localhost", "--peers"), (HostAddress{"127.0.0.1", 0}));
}

TEST(Network, a_host_that_cannot_be_is_named_with_the_option) {
  for (const std::string text :
       {"10.0.0.2:0", "10.0.0.2:70000", "10.0.0.2:x", "10.0.0.2:", ":7400", "", "no such host"})
    EXPECT_THAT(refusal([&] { resolve_host(text, "--peers"); }), HasSubstr("--peers " + text)) << text;
}

TEST(Network, loopback_alone_has_no_further_addresses) {
  EXPECT_THAT(interface_addresses({}), IsEmpty());
}

TEST(Network, an_unknown_interface_is_refused_with_the_known_ones) {
  NetworkOptions network;
  network.loopback_only = false;
  network.interfaces = {"eth99"};
  EXPECT_THAT(refusal([&] { interface_addresses(network); }), AllOf(HasSubstr("eth99"), HasSubstr("there are")));
}

TEST(Network, peers_elsewhere_need_a_network_profile) {
  EXPECT_THAT(refusal([] { require_network(with_peers({"10.0.0.2"})); }), HasSubstr("--profile lan"));
  EXPECT_THAT(refusal([] { require_network(with_peers({"127.0.0.1"})); }), IsEmpty());
}

TEST(Network, a_discovery_server_is_for_fast_dds_and_has_a_port) {
  BusOptions options;
  options.network.discovery_server = "127.0.0.1";
  EXPECT_THAT(refusal([&] { require_network(options); }), HasSubstr("HOST:PORT"));
  options.network.discovery_server = "127.0.0.1:11811";
  EXPECT_THAT(refusal([&] { require_network(options); }), IsEmpty());
  options.vendor = "cyclonedds";
  EXPECT_THAT(refusal([&] { require_network(options); }), HasSubstr("--peers"));
}

TEST(Network, raw_frames_and_features_stay_on_the_host) {
  for (const FrameTopic& frame : frame_topics()) EXPECT_TRUE(stays_on_host(frame.name)) << frame.name;
  EXPECT_TRUE(stays_on_host(topics::kFeatures.name));
  EXPECT_FALSE(stays_on_host(topics::kColorJpeg.name));
  EXPECT_FALSE(stays_on_host(topics::kDetections.name));
}

TEST(Network, the_partition_of_a_host_is_always_the_same) {
  EXPECT_EQ(host_partition(), host_partition());
  EXPECT_THAT(host_partition(), HasSubstr("host-"));
}

}  // namespace
}  // namespace rtd::bus
