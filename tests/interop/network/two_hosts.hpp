// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/component/launcher/rtd_command.hpp"

namespace rtd::test_support {

/// Two hosts on one machine: network namespaces with a /dev/shm each, joined by a 1 Gbit/s link (veth with a token
/// bucket) that lets no multicast through and drops `loss_percent` of the packets where they come in, so that IP
/// fragments count. Needs root; everything is gone with the object.
class TwoHosts {
 public:
  /// Why it cannot be done here; empty when it can.
  static std::string unavailable();
  static constexpr const char *kAddressA = "10.99.0.1", *kAddressB = "10.99.0.2";

  explicit TwoHosts(int loss_percent);
  ~TwoHosts();
  TwoHosts(const TwoHosts&) = delete;
  TwoHosts& operator=(const TwoHosts&) = delete;

  /// The words that run `command` on host 'a' or 'b'.
  std::vector<std::string> on(char host, std::vector<std::string> command) const;
  /// As if the cable were pulled out and put in again.
  void cut();
  void heal();
  /// Bytes that host a has sent through an interface: "eth0" is the link, "lo" its own loopback.
  std::uint64_t sent_by_a(const std::string& interface) const;

 private:
  void make(int loss_percent);
  void remove();
  std::string name(char host) const;
  void shape(char host, int loss_percent) const;

  launcher::RtdCommand holder_a_{"/bin/sh"}, holder_b_{"/bin/sh"};  ///< keep the mounts
  std::string pid_a_, pid_b_;
};

}  // namespace rtd::test_support
