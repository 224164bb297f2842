// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <vector>

#include "common/bus/backend.hpp"
#include "common/bus/bus_factory.hpp"
#include "common/bus/host/host_checks.hpp"
#include "common/bus/network.hpp"
#include "common/bus/port_check.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::bus {
namespace {

using testing::AllOf;
using ::testing::ElementsAre;
using testing::HasSubstr;

using testing::IsEmpty;

constexpr std::uint64_t kMib = 1024 * 1024;
const HostLimits kAmple{2048 * kMib, 2048 * kMib, 4 * kMib, 4 * kMib};

std::string shared_memory_error(const BusOptions& options, const HostLimits& limits) {
  try {
    require_shared_memory(options, limits);
  } catch (const BusError& error) {
    return error.what();
  }
  return {};
}

TEST(HostChecks, an_ample_host_passes_without_a_warning) {
  EXPECT_EQ(shared_memory_error({}, kAmple), "");
  EXPECT_THAT(host_warnings({}, kAmple), IsEmpty());
}

TEST(HostChecks, too_small_shared_memory_is_refused_with_size_and_fix) {
  HostLimits limits = kAmple;
  limits.shm_total = limits.shm_free = 8 * kMib;
  EXPECT_THAT(shared_memory_error({}, limits), AllOf(HasSubstr("/dev/shm"), HasSubstr("8 MiB"), HasSubstr("25 MiB"),
                                                     HasSubstr("mount -o remount,size="), HasSubstr("--shm-size=")));
}

TEST(HostChecks, full_shared_memory_is_refused_though_large) {
  HostLimits limits = kAmple;
  limits.shm_free = 10 * kMib;
  EXPECT_THAT(shared_memory_error({}, limits), HasSubstr("10 MiB free of 2048 MiB"));
}

TEST(HostChecks, a_larger_segment_needs_more_shared_memory) {
  HostLimits limits = kAmple;
  limits.shm_free = 64 * kMib;
  BusOptions options;
  EXPECT_EQ(shared_memory_error(options, limits), "");
  options.shm_segment_mib = 64;
  EXPECT_THAT(shared_memory_error(options, limits), HasSubstr("73 MiB"));
}

TEST(HostChecks, the_64_mib_of_a_default_container_are_warned_of) {
  HostLimits limits = kAmple;
  limits.shm_total = limits.shm_free = 64 * kMib;
  EXPECT_EQ(shared_memory_error({}, limits), "");
  EXPECT_THAT(host_warnings({}, limits), testing::ElementsAre(AllOf(HasSubstr("64 MiB"), HasSubstr("--shm-size="))));
}

TEST(HostChecks, small_socket_buffers_are_warned_of_with_the_command) {
  HostLimits limits = kAmple;
  limits.rmem_max = limits.wmem_max = 212'992;
  EXPECT_THAT(host_warnings({}, limits), testing::ElementsAre(HasSubstr("sudo sysctl -w net.core.rmem_max=4194304"),
                                                              HasSubstr("sudo sysctl -w net.core.wmem_max=4194304")));
}

TEST(HostChecks, what_could_not_be_read_is_not_complained_about) {
  EXPECT_EQ(shared_memory_error({}, HostLimits{}), "");
  EXPECT_THAT(host_warnings({}, HostLimits{}), IsEmpty());
  const HostLimits limits = read_host_limits("/nonexistent", "/nonexistent");
  EXPECT_EQ(limits.shm_total, 0U);
  EXPECT_EQ(limits.rmem_max, 0U);
}

TEST(HostChecks, ports_of_another_user_in_the_domain_are_named_with_udp_in_their_place) {
  if (geteuid() != 0) GTEST_SKIP() << "only root makes files of another user";
  const rtd::test::TemporaryFolder shm;
  const auto add = [&](const std::string& name, uid_t user, mode_t mode) {
    const std::string path = shm.write(name, "x");
    EXPECT_EQ(chmod(path.c_str(), mode) + chown(path.c_str(), user, user), 0);
  };
  add("fastrtps_port24161", 0, 0644);      // ours
  add("fastdds_port24163", 65534, 0666);   // open to all
  add("fastrtps_port24661", 65534, 0644);  // of domain 69
  add("fastrtps_1b3f0e", 65534, 0644);     // not a port
  add("fastrtps_port24661_el", 65534, 0644);
  BusOptions options;
  options.vendor = "fastdds";
  options.domain = 67;
  EXPECT_EQ(why_not_shared_memory(options, read_host_limits(shm.path())), "");
  add("fastrtps_port24165", 65534, 0644);
  const HostLimits limits = read_host_limits(shm.path());
  EXPECT_THAT(why_not_shared_memory(options, limits),
              AllOf(HasSubstr("user 65534"), HasSubstr("domain 67"), HasSubstr("port 24165"), HasSubstr("UDP")));
  EXPECT_THAT(host_warnings(options, limits), testing::Contains(HasSubstr("user 65534")));
  options.vendor = "cyclonedds";
  EXPECT_EQ(why_not_shared_memory(options, limits), "");
}

TEST(HostChecks, the_inprocess_bus_needs_nothing_of_the_host) {
  BusOptions options;
  options.vendor = kInprocess;
  EXPECT_THAT(host_warnings(options, {8 * kMib, kMib, 1000, 1000}), IsEmpty());
}

TEST(HostChecks, socket_buffer_is_capped_by_what_the_kernel_grants) {
  EXPECT_EQ(socket_buffer_bytes(4096, 4 * kMib), 4 * kMib);
  EXPECT_EQ(socket_buffer_bytes(4096, 212'992), 212'992U);
  EXPECT_EQ(socket_buffer_bytes(4096, 0), 4 * kMib);
}

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
  const rtd::test::TemporaryFolder folder;
  const std::string path = folder.file("udp");
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
