// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <string>
#include <thread>

#include "common/bus/fastdds/c_library.hpp"

namespace rtd::bus::fastdds {
namespace {

/// Uses a file as Fast DDS uses those of its ports.
class LockFiles : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "not with a sanitizer, with which these functions are those of the C library";
#endif
    link_c_library_functions();
    unlink(name_.c_str());
  }
  void TearDown() override {
    unlink(name_.c_str());
  }

  int open_or_create() const {
    const int file = open(name_.c_str(), O_RDONLY | O_CLOEXEC);
    return file >= 0 ? file : open(name_.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0600);
  }
  void give_back(int file) const {
    flock(file, LOCK_UN | LOCK_NB);
    close(file);
    std::remove(name_.c_str());
  }
  bool exists() const {
    return access(name_.c_str(), F_OK) == 0;
  }

  const std::string name_ = "/dev/shm/fast_test_" + std::to_string(getpid()) + "_el", new_ = name_ + ".new";
};

TEST_F(LockFiles, one_that_is_given_back_is_not_taken_for_one_that_was_left) {
  std::atomic<bool> ended{false};
  std::thread owner([&] {
    for (int round = 0; round < 20'000; ++round) {
      const int file = open(new_.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0600);
      flock(file, LOCK_EX | LOCK_NB);
      std::rename(new_.c_str(), name_.c_str());  // no other sees it unlocked
      give_back(file);
    }
    ended = true;
  });
  int taken_for_left = 0;
  while (!ended) {
    const int file = open(name_.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) continue;
    if (flock(file, LOCK_EX | LOCK_NB) == 0) {
      ++taken_for_left;
      give_back(file);
    } else {
      close(file);
    }
  }
  owner.join();
  EXPECT_EQ(taken_for_left, 0);
}

TEST_F(LockFiles, one_whose_owner_ended_without_giving_it_back_is_free_and_there) {
  const pid_t child = fork();
  if (child == 0) {
    flock(open_or_create(), LOCK_EX | LOCK_NB);
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  ASSERT_TRUE(exists());
  const int file = open_or_create();
  EXPECT_EQ(flock(file, LOCK_EX | LOCK_NB), 0);
  give_back(file);
  EXPECT_FALSE(exists());
}

TEST_F(LockFiles, one_that_is_held_stays) {
  const int file = open_or_create();
  ASSERT_EQ(flock(file, LOCK_SH | LOCK_NB), 0);
  EXPECT_EQ(std::remove(name_.c_str()), 0);
  const int other = open_or_create();
  EXPECT_EQ(flock(other, LOCK_SH | LOCK_NB), 0);
  give_back(file);
  EXPECT_TRUE(exists()) << "another holds it, too";
  give_back(other);
  EXPECT_FALSE(exists());
}

TEST_F(LockFiles, a_segment_of_another_user_that_may_only_be_read_is_copied) {
  if (geteuid() != 0) GTEST_SKIP() << "only root makes files of another user";
  const std::string number = std::to_string(getpid()), segment = "/fastrtps_" + number,
                    port = "/fastrtps_port" + number;
  for (const std::string& name : {segment, port}) {
    const int file = shm_open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    EXPECT_EQ(write(file, "message", 8), 8);
    close(file);
  }
  const pid_t child = fork();
  if (child == 0) {
    char text[8] = {};
    const bool other_user = setresuid(65534, 65534, 65534) == 0;
    const int copy = shm_open(segment.c_str(), O_RDWR, 0);
    const bool copied = pread(copy, text, 8, 0) == 8 && std::string(text) == "message" && pwrite(copy, "M", 1, 0) == 1;
    _exit(other_user && copied && shm_open(port.c_str(), O_RDWR, 0) < 0 ? 0 : 1);
  }
  int status = 1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  const int file = shm_open(segment.c_str(), O_RDONLY | O_CLOEXEC, 0);
  char first = 0;
  EXPECT_EQ(read(file, &first, 1), 1);
  EXPECT_EQ(first, 'm') << "theirs is as it was";
  close(file);
  for (const std::string& name : {segment, port}) shm_unlink(name.c_str());
}

TEST_F(LockFiles, a_segment_of_another_user_costs_no_more_memory_than_is_in_it_and_64_MiB_in_all) {
  if (geteuid() != 0) GTEST_SKIP() << "only root makes files of another user";
  const std::string number = std::to_string(getpid()), sparse = "/fastrtps_sparse" + number,
                    full = "/fastrtps_full" + number;
  constexpr off_t kGib = 1 << 30, kMib = 1 << 20;
  int file = shm_open(sparse.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  EXPECT_EQ(ftruncate(file, kGib), 0);
  EXPECT_EQ(pwrite(file, "message", 8, kGib - 8), 8);
  close(file);
  file = shm_open(full.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  const std::string mib(kMib, 'x');
  for (int i = 0; i < 65; ++i) EXPECT_EQ(write(file, mib.data(), mib.size()), kMib);
  close(file);
  const pid_t child = fork();
  if (child == 0) {
    char text[8] = {};
    struct stat status {};
    const bool other_user = setresuid(65534, 65534, 65534) == 0;
    const int copy = shm_open(sparse.c_str(), O_RDWR, 0);
    const bool copied = fstat(copy, &status) == 0 && status.st_size == kGib && status.st_blocks * 512 < kMib &&
                        pread(copy, text, 8, kGib - 8) == 8 && std::string(text) == "message";
    const bool refused = shm_open(full.c_str(), O_RDWR, 0) < 0 && errno == EACCES;
    _exit(other_user && copied && refused ? 0 : 1);
  }
  int status = 1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  for (const std::string& name : {sparse, full}) shm_unlink(name.c_str());
}

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
