// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/bus/host/ring_folder.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace rtd::bus {
namespace {

namespace fs = std::filesystem;

class RingFolder : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(scratch_); }
  void TearDown() override { fs::remove_all(scratch_); }
  const fs::path scratch_ = fs::temp_directory_path() / ("rtd_ring_folder_" + std::to_string(getpid()));
  const std::string asked_ = scratch_ / "rings";
};

TEST_F(RingFolder, is_made_for_its_user_alone_and_found_again) {
  EXPECT_EQ(ring_folder(asked_), asked_);
  EXPECT_EQ(fs::status(asked_).permissions(), fs::perms::owner_all);
  EXPECT_EQ(ring_folder(asked_), asked_);
}

TEST_F(RingFolder, is_none_where_another_user_may_write_or_has_made_it) {
  fs::create_directory(asked_);
  fs::permissions(asked_, fs::perms::owner_all | fs::perms::group_write);
  EXPECT_EQ(ring_folder(asked_), "");
  fs::permissions(asked_, fs::perms::owner_all);
  EXPECT_EQ(ring_folder(asked_), asked_);
  if (chown(asked_.c_str(), 65534, 65534) != 0) GTEST_SKIP() << "needs root, to give it to another user";
  EXPECT_EQ(ring_folder(asked_), "");
}

TEST_F(RingFolder, is_no_link_and_no_file) {
  fs::create_directory(scratch_ / "elsewhere");
  fs::permissions(scratch_ / "elsewhere", fs::perms::owner_all);
  fs::create_symlink(scratch_ / "elsewhere", asked_);
  EXPECT_EQ(ring_folder(asked_), "");
  fs::remove(asked_);
  std::ofstream(asked_) << "a file";
  EXPECT_EQ(ring_folder(asked_), "");
}

TEST_F(RingFolder, is_one_for_each_user_where_none_is_asked_for) {
  EXPECT_EQ(ring_folder(""), "/dev/shm/rtd_rings_" + std::to_string(geteuid()));
}

TEST_F(RingFolder, of_a_run_is_in_the_environment_of_its_services_and_goes_with_it) {
  std::string first;
  {
    const RingsOfRun run;
    first = std::getenv(kRingsVariable);
    EXPECT_EQ(ring_folder(first), first);
    EXPECT_NE(first, ring_folder(""));
    std::ofstream(first + "/fast_datasharing_01.0f.aa_0.0.3.3") << "of a service that was killed";
  }
  EXPECT_EQ(std::getenv(kRingsVariable), nullptr);
  EXPECT_FALSE(fs::exists(first));
}

}  // namespace
}  // namespace rtd::bus
