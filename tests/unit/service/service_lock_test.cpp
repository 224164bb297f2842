// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/service/service_lock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace rtd::service {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using namespace std::chrono_literals;

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
