// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <thread>
#include <utility>

#include "services/filter/core/load/load_watch.hpp"
#include "services/filter/processor_quota.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::filter {
namespace {

constexpr int kSteps = 4;
constexpr double kEasy = 20, kLate = 100;  // ms

/// Poses at 30 Hz.
class LoadWatchTest : public ::testing::Test {
 protected:
  /// True when the step has changed at least once.
  bool add(int frames, double latency_ms) {
    bool changed = false;
    for (int i = 0; i < frames; ++i) {
      now_ns_ += 33'333'333;
      changed = watch_.add(seq_++, latency_ms, now_ns_) || changed;
    }
    return changed;
  }
  void lose(int frames) {
    seq_ += static_cast<std::uint64_t>(frames);
    now_ns_ += frames * 33'333'333L;
  }
  /// Seconds until the step is taken back, at most 100.
  double seconds_until_less() {
    const int before = watch_.step();
    const std::int64_t since_ns = now_ns_;
    for (int i = 0; i < 3000 && watch_.step() >= before; ++i) add(1, kEasy);
    return static_cast<double>(now_ns_ - since_ns) * 1e-9;
  }

  LoadWatch watch_{LoadLimits{}, kSteps};
  std::uint64_t seq_ = 100;
  std::int64_t now_ns_ = 5'000'000'000;
};

TEST_F(LoadWatchTest, leaves_a_quick_pipeline_alone) {
  EXPECT_FALSE(add(1000, kEasy));
  EXPECT_EQ(watch_.step(), 0);
}

TEST_F(LoadWatchTest, one_late_pose_in_a_window_is_not_too_many) {
  for (int i = 0; i < 20; ++i) {
    add(1, kLate);
    add(12, kEasy);
  }
  EXPECT_EQ(watch_.step(), 0);
}

TEST_F(LoadWatchTest, sheds_a_step_for_late_poses_and_no_more_than_there_are) {
  add(2, kEasy);
  EXPECT_TRUE(add(2, kLate));
  EXPECT_EQ(watch_.step(), 1);
  EXPECT_EQ(watch_.burdened(), 2);
  EXPECT_FALSE(add(5, kLate)) << "they were on their way";
  add(100, kLate);
  EXPECT_EQ(watch_.step(), kSteps);
  EXPECT_FALSE(add(100, kLate));
}

TEST_F(LoadWatchTest, counts_missing_frames_as_burdened) {
  add(20, kEasy);
  lose(2);
  EXPECT_TRUE(add(1, kEasy));
  EXPECT_EQ(watch_.step(), 1);
}

TEST_F(LoadWatchTest, a_pause_of_the_camera_and_numbers_that_begin_again_are_no_burden) {
  add(20, kEasy);
  lose(300);
  EXPECT_FALSE(add(20, kEasy));
  seq_ = 0;
  EXPECT_FALSE(add(20, kEasy));
  EXPECT_EQ(watch_.step(), 0);
}

TEST_F(LoadWatchTest, what_is_late_because_nothing_ran_is_no_burden) {
  const auto stand_still = [this] {
    lose(8);
    watch_.stood_still(now_ns_);
    return add(3, kLate);
  };
  add(20, kEasy);
  add(2, kLate);
  ASSERT_EQ(watch_.step(), 1);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(stand_still());
    add(60, kEasy);
  }
  EXPECT_EQ(watch_.step(), 0) << "taken back meanwhile";
}

TEST_F(LoadWatchTest, a_computer_on_which_nothing_runs_again_and_again_is_overloaded) {
  add(20, kEasy);
  for (int i = 0; i < 10; ++i) {
    lose(8);
    watch_.stood_still(now_ns_);
    add(2, kLate);
  }
  EXPECT_GT(watch_.step(), 0);
}

TEST_F(LoadWatchTest, takes_back_after_a_calm_time_and_waits_longer_where_that_was_too_early) {
  add(2, kEasy);
  add(2, kLate);
  ASSERT_EQ(watch_.step(), 1);
  double calm_s = seconds_until_less();
  EXPECT_NEAR(calm_s, LoadLimits{}.calm_s, 1.0);
  for (int i = 0; i < 8; ++i) {
    ASSERT_EQ(watch_.step(), 0);
    add(2, kLate);
    ASSERT_EQ(watch_.step(), 1);
    const double before_s = std::exchange(calm_s, seconds_until_less());
    EXPECT_GT(calm_s, std::min(1.5 * before_s, LoadLimits{}.longest_calm_s - 1));
    EXPECT_LT(calm_s, LoadLimits{}.longest_calm_s + 2);
  }
}

TEST_F(LoadWatchTest, does_not_take_back_while_poses_are_nearly_late) {
  add(2, kEasy);
  add(2, kLate);
  EXPECT_FALSE(add(3000, LoadLimits{}.easy_latency_ms + 10));
  EXPECT_EQ(watch_.step(), 1);
}

TEST_F(LoadWatchTest, forgets_the_long_wait_after_a_long_good_time) {
  add(2, kEasy);
  for (int i = 0; i < 4; ++i) {
    add(2, kLate);
    seconds_until_less();
  }
  add(30 * 600, kEasy);
  add(2, kLate);
  EXPECT_NEAR(seconds_until_less(), LoadLimits{}.calm_s, 1.0);
}

TEST_F(LoadWatchTest, a_slow_computer_begins_with_its_step_and_takes_it_back_where_it_can) {
  watch_ = LoadWatch(LoadLimits{}, kSteps, kSteps);
  EXPECT_EQ(watch_.step(), kSteps);
  EXPECT_NEAR(seconds_until_less(), LoadLimits{}.calm_s, 0.2);
  EXPECT_EQ(watch_.step(), kSteps - 1);
}

namespace fs = std::filesystem;

/// A file system that has only what a test writes.
class ProcessorQuota : public testing::Test {
 protected:
  const rtd::test::TemporaryFolder root_;
  double all_ = std::max(1U, std::thread::hardware_concurrency());
};

TEST_F(ProcessorQuota, without_control_groups_all_cores_are_usable) {
  EXPECT_EQ(usable_cores(root_), all_);
}

TEST_F(ProcessorQuota, version_2_counts_the_smallest_of_all_groups_above) {
  root_.write("proc/self/cgroup", "0::/robot.slice/rtd\n");
  root_.write("sys/fs/cgroup/robot.slice/cpu.max", "50000 100000\n");
  root_.write("sys/fs/cgroup/robot.slice/rtd/cpu.max", "max 100000\n");
  EXPECT_DOUBLE_EQ(usable_cores(root_), 0.5);
}

TEST_F(ProcessorQuota, version_1_has_a_mount_for_each_controller) {
  root_.write("proc/self/cgroup", "5:memory:/m\n4:cpu,cpuacct:/half\n3:cpuset:/\n");
  root_.write("sys/fs/cgroup/cpu,cpuacct/half/cpu.cfs_quota_us", "30000\n");
  root_.write("sys/fs/cgroup/cpu,cpuacct/half/cpu.cfs_period_us", "100000\n");
  root_.write("sys/fs/cgroup/cpuset/cpu.cfs_quota_us", "1000\n");
  EXPECT_DOUBLE_EQ(usable_cores(root_), 0.3);
}

TEST_F(ProcessorQuota, no_quota_and_nonsense_are_no_limit) {
  root_.write("proc/self/cgroup", "4:cpu:/g\n0::/g\nnonsense\n");
  root_.write("sys/fs/cgroup/cpu/g/cpu.cfs_quota_us", "-1\n");
  root_.write("sys/fs/cgroup/cpu/g/cpu.cfs_period_us", "100000\n");
  root_.write("sys/fs/cgroup/g/cpu.max", "much 0\n");
  EXPECT_EQ(usable_cores(root_), all_);
}

}  // namespace
}  // namespace rtd::filter
