// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <string>

#include "common/service/run_service.hpp"
#include "common/service/service_lock.hpp"

namespace rtd::service {
namespace {

using Work = Heartbeat::Work;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using namespace std::chrono_literals;

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

/// A place that no other test has.
ServicePlace place(const std::string& service = "slam") {
  return {service, "lock_test_" + std::to_string(getpid()), 231};
}

TEST(ServiceLock, there_is_one_of_a_service_in_a_domain_and_for_a_robot) {
  const ServiceLock first(place());
  EXPECT_THAT([] { const ServiceLock second(place(), 0ms); },
              ThrowsMessage<AlreadyRuns>(HasSubstr("slam (pid " + std::to_string(getpid()) + ")")));
  const ServiceLock other_service(place("filter"), 0ms);
  ServicePlace other_domain = place(), other_robot = place();
  other_domain.domain = 230;
  other_robot.robot += "b";
  const ServiceLock elsewhere(other_domain, 0ms), of_another(other_robot, 0ms);
}

TEST(ServiceLock, the_place_of_a_killed_process_is_free) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const ServicePlace here = place();
  const pid_t child = fork();
  if (child == 0) {
    const ServiceLock lock(here, 0ms);
    (void)!write(ready[1], "x", 1);
    while (true) pause();
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_THAT([&] { const ServiceLock second(here, 0ms); },
              ThrowsMessage<AlreadyRuns>(HasSubstr("pid " + std::to_string(child))));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  const ServiceLock successor(here, 0ms);
  close(ready[0]);
  close(ready[1]);
}

}  // namespace
}  // namespace rtd::service
