// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/processor_quota.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <thread>

namespace rtd::filter {
namespace {

namespace fs = std::filesystem;

/// A file system that has only what a test writes.
class ProcessorQuota : public testing::Test {
 protected:
  ~ProcessorQuota() override { fs::remove_all(root_); }
  void write(const fs::path& file, const std::string& text) const {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text;
  }

  fs::path root_ = fs::path(testing::TempDir()) / ("rtd_quota_" + std::to_string(getpid()));
  double all_ = std::max(1U, std::thread::hardware_concurrency());
};

TEST_F(ProcessorQuota, without_control_groups_all_cores_are_usable) {
  EXPECT_EQ(usable_cores(root_), all_);
}

TEST_F(ProcessorQuota, version_2_counts_the_smallest_of_all_groups_above) {
  write("proc/self/cgroup", "0::/robot.slice/rtd\n");
  write("sys/fs/cgroup/robot.slice/cpu.max", "50000 100000\n");
  write("sys/fs/cgroup/robot.slice/rtd/cpu.max", "max 100000\n");
  EXPECT_DOUBLE_EQ(usable_cores(root_), 0.5);
}

TEST_F(ProcessorQuota, version_1_has_a_mount_for_each_controller) {
  write("proc/self/cgroup", "5:memory:/m\n4:cpu,cpuacct:/half\n3:cpuset:/\n");
  write("sys/fs/cgroup/cpu,cpuacct/half/cpu.cfs_quota_us", "30000\n");
  write("sys/fs/cgroup/cpu,cpuacct/half/cpu.cfs_period_us", "100000\n");
  write("sys/fs/cgroup/cpuset/cpu.cfs_quota_us", "1000\n");
  EXPECT_DOUBLE_EQ(usable_cores(root_), 0.3);
}

TEST_F(ProcessorQuota, no_quota_and_nonsense_are_no_limit) {
  write("proc/self/cgroup", "4:cpu:/g\n0::/g\nnonsense\n");
  write("sys/fs/cgroup/cpu/g/cpu.cfs_quota_us", "-1\n");
  write("sys/fs/cgroup/cpu/g/cpu.cfs_period_us", "100000\n");
  write("sys/fs/cgroup/g/cpu.max", "much 0\n");
  EXPECT_EQ(usable_cores(root_), all_);
}

}  // namespace
}  // namespace rtd::filter
