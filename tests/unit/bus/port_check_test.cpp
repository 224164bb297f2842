// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/port_check.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <vector>

#include "common/bus/backend.hpp"
#include "common/bus/bus_factory.hpp"
#include "common/bus/network.hpp"

namespace rtd::bus {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Holds a UDP port.
class Holder {
 public:
  explicit Holder(std::uint16_t port, int shared = 0) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &shared, sizeof(shared));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    held_ = bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  }
  ~Holder() { close(socket_); }
  Holder(const Holder&) = delete;
  Holder& operator=(const Holder&) = delete;
  bool held() const { return held_; }

 private:
  int socket_;
  bool held_ = false;
};

std::uint32_t domain() {
  return 200 + static_cast<std::uint32_t>(getpid()) % 30;
}

TEST(PortCheck, a_port_that_is_not_shared_is_named_with_the_way_out) {
  const Holder other(discovery_port(domain()), 0);
  if (!other.held()) GTEST_SKIP() << "the port of domain " << domain() << " is in use";
  for (const std::string& vendor : dds_vendors()) {
    BusOptions options;
    options.vendor = vendor;
    options.domain = domain();
    try {
      connect(options);
      ADD_FAILURE() << vendor << " joined a domain whose port is taken";
    } catch (const BusError& error) {
      EXPECT_THAT(error.what(), HasSubstr("UDP port " + std::to_string(discovery_port(domain()))));
      EXPECT_THAT(error.what(), HasSubstr("--domain"));
    }
  }
}

TEST(PortCheck, a_shared_port_is_accepted) {
  const Holder other(discovery_port(domain()), 1);
  if (!other.held()) GTEST_SKIP() << "the port of domain " << domain() << " is in use";
  EXPECT_NO_THROW(require_discovery_port(domain()));
}

TEST(PortCheck, ports_of_participants_are_read_from_the_kernel_table) {
  const std::string path = ::testing::TempDir() + "rtd_udp_table_" + std::to_string(getpid());
  std::ofstream(path)
      << "  sl  local_address rem_address   st tx_queue rx_queue\n"
      << "  10: 0100007F:1CF2 00000000:0000 07 0:0 00:0 0 0 0 1\n"  // 7410
      << "  11: 00000000:1CF3 00000000:0000 07 0:0 00:0 0 0 0 2\n"  // 7411: of data
      << "  12: 0200000A:1D10 00000000:0000 07 0:0 00:0 0 0 0 3\n"
      << "  13: 00000000:1DE2 00000000:0000 07 0:0 00:0 0 0 0 4\n"
      << "  15: 0100FFEF:1EDC 00000000:0000 07 0:0 00:0 0 0 0 6\n"   // 7900: all of domain 2   // 7650: all of domain 1
      << "  14: 0100007F:1FD6 00000000:0000 07 0:0 00:0 0 0 0 5\n";  // 7440
  EXPECT_EQ(free_participant_ports(0, path), kPeerParticipants - 2);
  EXPECT_THAT(domains_in_use(path), ElementsAre(1U, 2U));
  EXPECT_THAT(other_domains_hint(0, path), HasSubstr("on this host DDS runs in domain 1, 2: "));
  EXPECT_THAT(other_domains_hint(1, path), HasSubstr("in domain 2: "));
  EXPECT_EQ(other_domains_hint(0, "/no/such/table"), "");
  EXPECT_EQ(free_participant_ports(1, path), kPeerParticipants);
  BusOptions options;
  EXPECT_TRUE(surely_empty(options, path));
  EXPECT_FALSE(surely_empty(options, "/no/such/table"));
  options.domain = 2;
  EXPECT_FALSE(surely_empty(options, path)) << "in use";
  options.domain = 0;
  options.network.peers = {"127.0.0.1"};
  EXPECT_FALSE(surely_empty(options, path)) << "they need no common port";
  options.network = {};
  options.network.loopback_only = false;
  EXPECT_FALSE(surely_empty(options, path)) << "on another host";
  EXPECT_EQ(free_participant_ports(0, "/no/such/table"), kPeerParticipants);
  std::remove(path.c_str());
}

TEST(PortCheck, without_a_free_port_for_peers_no_process_joins_a_network) {
  std::vector<std::unique_ptr<Holder>> others;
  for (int id = 0; id < kPeerParticipants; ++id)
    others.push_back(std::make_unique<Holder>(participant_port(domain(), id)));
  for (const std::string& vendor : dds_vendors()) {
    BusOptions options;
    options.vendor = vendor;
    options.domain = domain();
    EXPECT_NO_THROW(connect(options)) << "no need of them on this host alone";
    options.network.multicast = false;
    try {
      connect(options);
      ADD_FAILURE() << vendor << " joined without a port";
    } catch (const BusError& error) {
      EXPECT_THAT(error.what(), HasSubstr("UDP ports from " + std::to_string(participant_port(domain(), 0))));
      EXPECT_THAT(error.what(), HasSubstr("--domain"));
    }
  }
}

TEST(PortCheck, ports_follow_the_standard) {
  EXPECT_EQ(participant_port(1, 2), 7664);
  EXPECT_EQ(discovery_port(0), 7400);
  EXPECT_EQ(discovery_port(232), 65400);
}

}  // namespace
}  // namespace rtd::bus
