// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/fastdds/c_library.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <ctime>

namespace rtd::bus::fastdds {
namespace {

/// In memory that a forked process shares, set up as Fast DDS does.
pthread_mutex_t* make_lock() {
  void* memory = mmap(nullptr, sizeof(pthread_mutex_t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  auto* lock = static_cast<pthread_mutex_t*>(memory);
  pthread_mutexattr_t attributes;
  pthread_mutexattr_init(&attributes);
  pthread_mutexattr_setpshared(&attributes, PTHREAD_PROCESS_SHARED);
  pthread_mutex_init(lock, &attributes);
  return lock;
}

timespec after(std::chrono::nanoseconds pause) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t ns = (std::chrono::system_clock::now().time_since_epoch() + pause).count();
  return {ns / kSecond, ns % kSecond};
}

/// A process that takes the lock and is killed while it holds it.
void die_in(pthread_mutex_t& lock) {
  const pid_t child = fork();
  if (child == 0) {
    pthread_mutex_lock(&lock);
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
}

class RobustLocks : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "not with a sanitizer, which replaces these functions itself";
#endif
    void* held = nullptr;
    std::size_t size = 0;
    if (syscall(SYS_get_robust_list, 0, &held, &size) != 0)
      GTEST_SKIP() << "the kernel does not learn which locks a process holds, as under qemu-user";
    link_c_library_functions();
    lock_ = make_lock();
  }
  pthread_mutex_t* lock_ = nullptr;
};

TEST_F(RobustLocks, one_whose_owner_was_killed_is_free_at_once_and_stays_usable) {
  const timespec until = after(std::chrono::seconds(5));
  for (int round = 0; round < 3; ++round) {
    die_in(*lock_);
    ASSERT_EQ(pthread_mutex_timedlock(lock_, &until), 0) << "round " << round;
    ASSERT_EQ(pthread_mutex_unlock(lock_), 0);
  }
}

TEST_F(RobustLocks, one_whose_owner_lives_is_waited_for) {
  for (const bool killed : {false, true}) {
    const pid_t child = fork();
    if (child == 0) {
      pthread_mutex_lock(lock_);
      usleep(300'000);
      if (killed) raise(SIGKILL);
      pthread_mutex_unlock(lock_);
      _exit(0);
    }
    while (pthread_mutex_trylock(lock_) == 0) {
      pthread_mutex_unlock(lock_);
      usleep(1000);
    }
    const timespec until = after(std::chrono::milliseconds(10));
    EXPECT_EQ(pthread_mutex_timedlock(lock_, &until), 0) << (killed ? "until it is killed" : "");
    EXPECT_EQ(pthread_mutex_unlock(lock_), 0);
    waitpid(child, nullptr, 0);
  }
}

/// A library finds the functions of the program before those of the C library.
TEST_F(RobustLocks, are_those_that_fast_dds_finds) {
  Dl_info ours{}, found{};
  ASSERT_NE(dladdr(reinterpret_cast<void*>(&link_c_library_functions), &ours), 0);
  for (const char* name : {"pthread_mutexattr_setpshared", "pthread_mutex_timedlock"}) {
    ASSERT_NE(dladdr(dlsym(RTLD_DEFAULT, name), &found), 0) << name;
    EXPECT_STREQ(found.dli_fname, ours.dli_fname) << name;
  }
}

}  // namespace
}  // namespace rtd::bus::fastdds
