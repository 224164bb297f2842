// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "common/bus/bus_factory.hpp"
#include "tests/support/test_domain.hpp"

extern char** environ;

namespace rtd::bus {

/// A bus_peer that is asked to end with this object. Killing it is for tests of that: Fast DDS 2.9 ends the reader's
/// process too when the writer's is killed in the microseconds in which it holds the lock of a data-sharing
/// notification.
class PeerProcess {
 public:
  PeerProcess(std::string vendor, std::string role, std::uint32_t domain, int count = 0) {
    std::string path = BUS_PEER_PATH, domain_text = std::to_string(domain), count_text = std::to_string(count);
    char* argv[] = {path.data(), vendor.data(), role.data(), domain_text.data(), count_text.data(), nullptr};
    if (posix_spawn(&pid_, path.c_str(), nullptr, nullptr, argv, environ) != 0) {
      throw std::runtime_error("cannot start " + path);
    }
  }
  ~PeerProcess() { end_by(SIGTERM); }
  PeerProcess(const PeerProcess&) = delete;
  PeerProcess& operator=(const PeerProcess&) = delete;

  void kill_now() { end_by(SIGKILL); }
  pid_t pid() const { return pid_; }

 private:
  void end_by(int signal) {
    if (pid_ <= 0) return;
    kill(pid_, signal);
    waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }

  pid_t pid_ = 0;
};

/// A connection to that domain.
inline std::shared_ptr<Bus> connect_to(const std::string& vendor) {
  BusOptions options;
  options.vendor = vendor;
  options.domain = test_domain();
  options.participant_name = "bus-test";
  return connect(options);
}

/// The suffix of a test that is run for a vendor.
inline std::string test_name(const testing::TestParamInfo<std::string>& test) {
  return test.param;
}

}  // namespace rtd::bus
