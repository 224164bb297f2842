// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/port_check.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/bus/backend.hpp"
#include "common/bus/bus_factory.hpp"

namespace rtd::bus {
namespace {

using ::testing::HasSubstr;

/// Holds a domain's port; -1 when somebody else has it.
class Holder {
 public:
  Holder(std::uint32_t domain, int shared) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &shared, sizeof(shared));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(discovery_port(domain));
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
  const Holder other(domain(), 0);
  if (!other.held()) GTEST_SKIP() << "the port of domain " << domain() << " is in use";
  for (const std::string& vendor : available_vendors()) {
    if (vendor == "inprocess") continue;
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

TEST(PortCheck, a_shared_port_is_no_trouble) {
  const Holder other(domain(), 1);
  if (!other.held()) GTEST_SKIP() << "the port of domain " << domain() << " is in use";
  EXPECT_NO_THROW(require_discovery_port(domain()));
}

TEST(PortCheck, ports_follow_the_standard) {
  EXPECT_EQ(discovery_port(0), 7400);
  EXPECT_EQ(discovery_port(232), 65400);
}

}  // namespace
}  // namespace rtd::bus
