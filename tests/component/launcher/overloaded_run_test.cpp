// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// A run on a computer that has no time for it: half of the frames are lost on the way, other programs take the
// processors, and again and again nothing runs at all.
#include <gmock/gmock.h>

#include <sys/wait.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/sanitizers.hpp"

namespace rtd::launcher {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Each in a session of its own, to which Linux gives as much as to the whole run.
class BusyProcesses {
 public:
  explicit BusyProcesses(unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      const pid_t pid = fork();
      if (pid == 0) {
        setsid();
        alarm(kLongest_s);
        while (getppid() != 1) continue;
      }
      if (pid > 0) pids_.push_back(pid);
    }
  }
  ~BusyProcesses() {
    for (const pid_t pid : pids_) ::kill(pid, SIGKILL);
    for (const pid_t pid : pids_) waitpid(pid, nullptr, 0);
  }
  BusyProcesses(const BusyProcesses&) = delete;
  BusyProcesses& operator=(const BusyProcesses&) = delete;

 private:
  static constexpr unsigned kLongest_s = 200;
  std::vector<pid_t> pids_;
};

class OverloadedRun : public testing::Test {
 protected:
  std::string log(const std::string& service) const { return text_of(out_ + "/logs/" + service + ".log"); }
  pid_t pid_of(const std::string& service) const { return pid_in(log(service)); }
  /// While the camera plays.
  void stop_everything_again_and_again() {
    constexpr std::chrono::milliseconds kBurst{300}, kBetween{2000};
    std::vector<pid_t> all = {static_cast<pid_t>(rtd_.process())};
    for (const char* service : {"camera", "filter", "slam"}) all.push_back(pid_of(service));
    ASSERT_THAT(all, testing::Each(testing::Gt(0)));
    for (; bursts_ < 6; ++bursts_) {
      std::this_thread::sleep_for(kBetween);
      for (const pid_t pid : all) ::kill(pid, SIGSTOP);
      std::this_thread::sleep_for(kBurst);
      for (const pid_t pid : all) ::kill(pid, SIGCONT);
      rtd_.take_output();
    }
  }

  ScratchFolder scratch_;
  std::string out_ = scratch_ / "out";
  RtdCommand rtd_;
  int bursts_ = 0;
};

TEST_F(OverloadedRun, keeps_its_pose_with_the_newest_frames) {
  if (test_support::kSanitized) GTEST_SKIP() << test_support::kTooSlow;
  const BusyProcesses others(3 * std::max(2U, std::thread::hardware_concurrency()));
  rtd_.start({"run", "--source", "synthetic:office?frames=240&drops=0.5", "--out", out_, "--domain", "78", "--detector",
              "off", "--pace", "realtime"});
  for (int i = 0; i < 600 && log("camera").find("event=all_ready") == std::string::npos; ++i)
    rtd_.wait_for("never printed", std::chrono::milliseconds(50));
  stop_everything_again_and_again();
  ASSERT_EQ(rtd_.wait(std::chrono::seconds(120)), 0) << rtd_.output();
  const nlohmann::json report = nlohmann::json::parse(text_of(out_ + "/report.json"));
  EXPECT_GE(report["frames_tracked"].get<double>(), 0.99 * report["frames_used"].get<double>());
  EXPECT_LT(report["ate_rmse_m"], 0.03);
  EXPECT_THAT(log("slam"), Not(HasSubstr("event=tracking_lost")));
  for (const char* service : {"camera", "filter", "slam"}) EXPECT_EQ(report["restarts"][service], 0) << service;
}

}  // namespace
}  // namespace rtd::launcher
