// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/host/shm_leftovers.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

namespace rtd::bus {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

/// A process that does something to begin with, then stays until it is killed.
class Child {
 public:
  explicit Child(const std::function<void()>& begin) {
    int ready[2];
    if (pipe(ready) != 0) std::abort();
    pid_ = fork();
    if (pid_ == 0) {
      begin();
      if (write(ready[1], "", 1) != 1) _exit(1);
      while (true) pause();
    }
    close(ready[1]);
    char byte = 0;
    if (::read(ready[0], &byte, 1) != 1) std::abort();
    close(ready[0]);
  }
  ~Child() { kill_now(); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  void kill_now() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    pid_ = 0;
  }

 private:
  pid_t pid_ = 0;
};

class ShmLeftovers : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/dev/shm/rtd_leftovers_XXXXXX";
    folder_ = mkdtemp(name);
    fs::permissions(folder_, fs::perms::all);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ + '/' + name; }
  void make(const std::string& name) const { std::ofstream(path(name)) << std::string(8192, 'x'); }
  void map(const std::string& name) const {
    const int file = open(path(name).c_str(), O_RDWR);
    if (mmap(nullptr, 8192, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0) == MAP_FAILED) _exit(1);
    close(file);
  }
  CleanReport clean(int min_age_s = 0) const {
    return remove_shm_leftovers({.shm_dir = folder_, .min_age = std::chrono::seconds(min_age_s)});
  }
  static std::vector<std::string> names(const std::vector<ShmFile>& files) {
    std::vector<std::string> all;
    for (const ShmFile& file : files) all.push_back(file.name);
    return all;
  }
  std::string reason(const CleanReport& report, const std::string& name) const {
    for (const ShmFile& file : report.left) {
      if (file.name == name) return file.reason;
    }
    return "was not left";
  }

  std::string folder_;
};

TEST_F(ShmLeftovers, of_a_killed_process_go_and_those_of_a_living_one_stay) {
  make("fast_datasharing_01.0f.aa_0.0.3.3");
  make("fast_datasharing_01.0f.bb_0.0.3.3");
  Child killed([&] { map("fast_datasharing_01.0f.aa_0.0.3.3"); });
  const Child living([&] { map("fast_datasharing_01.0f.bb_0.0.3.3"); });
  EXPECT_THAT(clean().removed, IsEmpty());

  killed.kill_now();
  const CleanReport report = clean();
  EXPECT_THAT(names(report.removed), UnorderedElementsAre("fast_datasharing_01.0f.aa_0.0.3.3"));
  EXPECT_GE(report.removed_bytes(), 8192U);
  EXPECT_EQ(reason(report, "fast_datasharing_01.0f.bb_0.0.3.3"), "in use");
  EXPECT_TRUE(fs::exists(path("fast_datasharing_01.0f.bb_0.0.3.3")));
}

TEST_F(ShmLeftovers, in_folders_of_rings_go_too_and_then_the_empty_folders) {
  fs::create_directory(path("rtd_rings_1000"));
  make("rtd_rings_1000/fast_datasharing_01.0f.aa_0.0.3.3");
  make("rtd_rings_1000/fast_datasharing_01.0f.bb_0.0.3.3");
  make("rtd_rings_1000/notes");
  fs::create_directory(path("rtd_rings_1000_aBcDeF"));
  make("rtd_rings_1000_aBcDeF/fast_datasharing_01.0f.cc_0.0.3.3");
  const Child living([&] { map("rtd_rings_1000/fast_datasharing_01.0f.bb_0.0.3.3"); });
  const CleanReport report = clean();
  EXPECT_THAT(names(report.removed), UnorderedElementsAre("rtd_rings_1000/fast_datasharing_01.0f.aa_0.0.3.3",
                                                          "rtd_rings_1000_aBcDeF/fast_datasharing_01.0f.cc_0.0.3.3"));
  EXPECT_EQ(reason(report, "rtd_rings_1000/fast_datasharing_01.0f.bb_0.0.3.3"), "in use");
  EXPECT_TRUE(fs::exists(path("rtd_rings_1000/notes")));
  EXPECT_FALSE(fs::exists(path("rtd_rings_1000_aBcDeF")));

  fs::create_directory(path("rtd_rings_1001"));
  clean(3600);
  EXPECT_TRUE(fs::exists(path("rtd_rings_1001"))) << "a service may be about to use it";
}

TEST_F(ShmLeftovers, behind_a_link_are_not_touched) {
  fs::create_directory(path("elsewhere"));
  make("elsewhere/fast_datasharing_01.0f.aa_0.0.3.3");
  fs::create_symlink(path("elsewhere"), path("rtd_rings_1000"));
  EXPECT_THAT(clean().removed, IsEmpty());
  EXPECT_TRUE(fs::exists(path("rtd_rings_1000/fast_datasharing_01.0f.aa_0.0.3.3")));
}

TEST_F(ShmLeftovers, files_of_one_port_stay_together) {
  for (const char* name : {"fastrtps_port7412", "fastrtps_port7412_el", "sem.fastrtps_port7412_mutex"}) make(name);
  for (const char* name : {"fastrtps_port7415", "sem.fastrtps_port7415_mutex"}) make(name);
  const Child living([&] { map("fastrtps_port7412"); });
  EXPECT_THAT(names(clean().removed), UnorderedElementsAre("fastrtps_port7415", "sem.fastrtps_port7415_mutex"));
}

TEST_F(ShmLeftovers, an_open_or_locked_file_is_in_use) {
  make("fastrtps_00a20056a0830cc2_el");
  make("fastrtps_1111111111111111");
  const Child living([&] {
    const int lock = open(path("fastrtps_00a20056a0830cc2_el").c_str(), O_RDONLY);
    if (lock < 0 || flock(lock, LOCK_EX) != 0 || open(path("fastrtps_1111111111111111").c_str(), O_RDWR) < 0) _exit(1);
  });
  EXPECT_THAT(clean().removed, IsEmpty());
  // Seen from where the process is not: only the lock shows it.
  const CleanReport blind = remove_shm_leftovers(
      {.shm_dir = folder_, .proc_dir = "/nonexistent", .min_age = std::chrono::seconds(0), .dry_run = true});
  EXPECT_THAT(names(blind.removed), UnorderedElementsAre("fastrtps_1111111111111111"));
  EXPECT_EQ(reason(blind, "fastrtps_00a20056a0830cc2_el"), "locked by a process");
}

TEST_F(ShmLeftovers, a_young_file_may_belong_to_a_process_that_starts) {
  make("fastrtps_00a20056a0830cc2");
  const CleanReport report = clean(3600);
  EXPECT_THAT(report.removed, IsEmpty());
  EXPECT_EQ(reason(report, "fastrtps_00a20056a0830cc2"), "younger than 3600 s");
}

TEST_F(ShmLeftovers, files_of_others_are_not_touched) {
  for (const char* name : {"psm_1234", "sem.other", "lttng-ust-wait", "my_fastrtps_copy"}) make(name);
  const CleanReport report = clean();
  EXPECT_THAT(report.removed, IsEmpty());
  EXPECT_THAT(report.left, IsEmpty());
}

/// Runs as user `nobody` in a process of its own; 0 = success.
int as_unprivileged_user(const std::function<bool()>& test) {
  const pid_t child = fork();
  if (child == 0) {
    constexpr uid_t kUnprivilegedUser = 65534;
    if (setgid(kUnprivilegedUser) != 0 || setuid(kUnprivilegedUser) != 0) _exit(2);
    _exit(test() ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(ShmLeftovers, a_process_of_the_owner_that_cannot_be_read_keeps_them) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to become another user";
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the thread sanitizer allows no thread in a forked process";
#endif
  const auto test = [&] {
    make("fastrtps_00a20056a0830cc2");
    bool kept = false;
    {
      const Child hidden([] {
        std::thread([] { pause(); }).detach();  // DDS has threads: a process without is no user
        prctl(PR_SET_DUMPABLE, 0);
      });
      kept = reason(clean(), "fastrtps_00a20056a0830cc2").find("cannot be inspected") != std::string::npos;
    }
    return kept && clean().removed.size() == 1;
  };
  EXPECT_EQ(as_unprivileged_user(test), 0);
}

TEST_F(ShmLeftovers, of_another_user_are_left_with_the_reason) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to become another user";
  make("fastrtps_00a20056a0830cc2");
  fs::permissions(folder_, fs::perms::all | fs::perms::sticky_bit);
  EXPECT_EQ(as_unprivileged_user([&] { return !reason(clean(), "fastrtps_00a20056a0830cc2").empty(); }), 0);
  EXPECT_TRUE(fs::exists(path("fastrtps_00a20056a0830cc2")));
}

TEST_F(ShmLeftovers, a_missing_folder_is_accepted) {
  EXPECT_THAT(remove_shm_leftovers({.shm_dir = "/nonexistent"}).left, IsEmpty());
}

}  // namespace
}  // namespace rtd::bus
