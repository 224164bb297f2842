// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// A run in which everything is stopped and continues, as in a paused container. RTD_PAUSE_S: how long, at
// both paces; without it 10 s at one pace for each vendor.
#include <gmock/gmock.h>

#include <cstdlib>
#include <thread>

#include "common/bus/bus_factory.hpp"
#include "tests/component/launcher/rtd_command.hpp"

namespace rtd::launcher {
namespace {

using testing::HasSubstr;
using testing::Not;

class PausedRun : public testing::TestWithParam<std::string> {
 protected:
  std::string log(const std::string& service) const { return text_of(out_ + "/logs/" + service + ".log"); }
  pid_t pid_of(const std::string& service) const { return pid_in(log(service)); }
  bool wait_for_log(const std::string& service, const std::string& text) {
    for (int i = 0; i < 600; ++i) {
      if (log(service).find(text) != std::string::npos) return true;
      rtd_.wait_for("never printed", std::chrono::milliseconds(50));
    }
    return false;
  }
  static std::chrono::seconds pause() {
    const char* const text = std::getenv("RTD_PAUSE_S");
    return std::chrono::seconds(text == nullptr ? 10 : std::atoi(text));
  }
  static std::vector<std::string> paces() {
    if (std::getenv("RTD_PAUSE_S") != nullptr) return {"lockstep", "realtime"};
    return {GetParam() == "fastdds" ? "lockstep" : "realtime"};
  }
  /// The launcher continues first: it could kill the others.
  void stop_everything_for_a_while() {
    std::vector<pid_t> all = {static_cast<pid_t>(rtd_.process())};
    for (const char* service : {"camera", "filter", "slam"}) all.push_back(pid_of(service));
    for (const pid_t pid : all) ASSERT_EQ(send_signal(pid, SIGSTOP), 0) << pid;
    std::this_thread::sleep_for(pause());
    for (const pid_t pid : all) ASSERT_EQ(send_signal(pid, SIGCONT), 0) << pid;
  }
  static long count(const std::string& text, const std::string& part) {
    long found = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
  }

  ScratchFolder scratch_;
  std::string out_ = scratch_ / "out";
  RtdCommand rtd_;
};

TEST_P(PausedRun, continues_with_all_services_and_the_same_map) {
  for (const std::string& pace : paces()) {
    out_ = scratch_ / pace;
    rtd_.start({"run", "--source", "synthetic:office?frames=150", "--out", out_, "--domain", "77", "--detector", "off",
                "--pace", pace, "--dds", GetParam()});
    ASSERT_TRUE(wait_for_log("slam", "event=map_started")) << rtd_.output();
    stop_everything_for_a_while();
    ASSERT_EQ(rtd_.wait(std::chrono::seconds(120)), 0) << rtd_.output();
    for (const char* wrong : {"killed", "restarted", "died"}) EXPECT_THAT(rtd_.output(), Not(HasSubstr(wrong)));
    EXPECT_EQ(count(log("slam"), "event=map_started"), 1) << log("slam");
    EXPECT_EQ(count(log("camera"), "event=started"), 1);
    const long poses = count(text_of(out_ + "/trajectory.txt"), "\n");
    EXPECT_GE(poses, pace == "lockstep" ? 150 : 120) << pace;
  }
}

INSTANTIATE_TEST_SUITE_P(Vendors, PausedRun, testing::ValuesIn(bus::dds_vendors()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace rtd::launcher
