// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

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

/// Of a connection to the domain of this process.
inline BusOptions options_of(const std::string& vendor, const std::string& name = "bus-test") {
  BusOptions options;
  options.vendor = vendor;
  options.domain = test_domain();
  options.participant_name = name;
  return options;
}
inline std::shared_ptr<Bus> connect_to(const std::string& vendor) {
  return connect(options_of(vendor));
}

/// Until each of these readers and writers has met one.
template <class... Ends>
void wait_matched(const Ends&... ends) {
  for (int i = 0; i < 10'000 && ((ends.matched() == 0) || ...); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ASSERT_TRUE(((ends.matched() > 0) && ...));
}

/// The suffix of a test that is run for a vendor.
inline std::string test_name(const testing::TestParamInfo<std::string>& test) {
  return test.param;
}

}  // namespace rtd::bus
