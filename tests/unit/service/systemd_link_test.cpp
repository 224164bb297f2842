// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/run_service.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <optional>
#include <string>

namespace rtd::service {
namespace {

using Work = Heartbeat::Work;

/// The socket of a service manager.
class Manager {
 public:
  Manager() : socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string name = "rtd-systemd-test-" + std::to_string(getpid());
    name.copy(address.sun_path + 1, sizeof(address.sun_path) - 2);  // abstract: leaves no file
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), length), 0);
    setenv("NOTIFY_SOCKET", ("@" + name).c_str(), 1);
  }
  ~Manager() {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    close(socket_);
  }
  static void watch(int ms) { setenv("WATCHDOG_USEC", std::to_string(1000 * ms).c_str(), 1); }

  /// The next message within the time.
  std::optional<std::string> receive(int timeout_ms) const {
    const timeval timeout{timeout_ms / 1000, 1000L * (timeout_ms % 1000)};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof(timeout));
    std::array<char, 256> text{};
    const ssize_t got = recv(socket_, text.data(), text.size(), 0);
    if (got < 0) return std::nullopt;
    return std::string(text.data(), static_cast<std::size_t>(got));
  }

 private:
  const int socket_;
};

TEST(SystemdLink, says_ready_when_the_worker_has_begun_and_when_it_ends) {
  const Manager manager;
  std::atomic<Work> work = Work::kNotBegun;
  {
    const SystemdLink link([&] { return work.load(); });
    EXPECT_EQ(manager.receive(200), std::nullopt) << "not before";
    work = Work::kContinues;
    EXPECT_EQ(manager.receive(2000), "READY=1");
    EXPECT_EQ(manager.receive(200), std::nullopt) << "no watchdog asks";
  }
  EXPECT_EQ(manager.receive(2000), "STOPPING=1");
}

TEST(BoundedEnd, says_that_the_work_is_done) {
  const Manager manager;
  BoundedEnd end("rtd-slam");
  end.begin(0, std::chrono::seconds(60));
  EXPECT_EQ(manager.receive(2000), "STOPPING=1");
}

TEST(SystemdLink, feeds_the_watchdog_until_the_worker_is_stuck) {
  const Manager manager;
  Manager::watch(90);
  std::atomic<Work> work = Work::kContinues;
  const SystemdLink link([&] { return work.load(); });
  EXPECT_EQ(manager.receive(2000), "READY=1");
  for (int i = 0; i < 5; ++i) EXPECT_EQ(manager.receive(2000), "WATCHDOG=1");
  work = Work::kStuck;
  while (manager.receive(100)) {
  }  // what was on its way
  EXPECT_EQ(manager.receive(300), std::nullopt);
}

TEST(SystemdLink, a_service_that_was_stopped_for_most_of_the_time_has_the_rest_to_give_a_sign) {
  const Manager manager;
  Manager::watch(9000);
  const SystemdLink link([] { return Work::kContinues; });
  EXPECT_EQ(manager.receive(2000), "READY=1");
  EXPECT_EQ(manager.receive(2000), "WATCHDOG=1");
  EXPECT_EQ(manager.receive(2800), "WATCHDOG=1") << "the next one comes before a third of the time is over";
}

TEST(SystemdLink, is_silent_without_systemd) {
  const SystemdLink link([]() -> Work {
    ADD_FAILURE() << "asked";
    return Work::kContinues;
  });
}

}  // namespace
}  // namespace rtd::service
