// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "common/bus/bus_factory.hpp"
#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/sanitizers.hpp"

namespace rtd::launcher {
namespace {

using testing::HasSubstr;
using testing::Not;

struct Outcome {
  double poses = 0, frames = 0, ate_m = 0;
  std::string written;  ///< by the attacker
};

/// A running pipeline in real time, and a peer without keys that writes to every topic and command a thousand times a
/// second. RTD_FLOOD_S makes the attack longer than six seconds; 60 and more are judged by the asked figures, six leave
/// room for a busy computer.
class FloodTest : public testing::TestWithParam<std::string> {
 protected:
  static int seconds() {
    const char* asked = std::getenv("RTD_FLOOD_S");
    return asked == nullptr ? 6 : std::atoi(asked);
  }
  std::vector<std::string> arguments(const std::string& out) const {
    const std::string source = "synthetic:office?frames=" + std::to_string(30 * seconds());
    return {"run",      "--source", source,   "--out",      out,   "--dds",
            GetParam(), "--domain", domain(), "--detector", "off", "--dense"};
  }
  static std::string domain() { return GetParam() == "fastdds" ? "81" : "82"; }

  Outcome run(bool attacked) {
    const std::string out = scratch_ / (attacked ? "attacked" : "quiet");
    RtdCommand rtd, attacker(FLOOD_PEER_PATH);
    rtd.start(arguments(out));
    EXPECT_TRUE(rtd.wait_for(" fps ")) << rtd.output();  // the first source of a topic is followed
    if (attacked) attacker.start({GetParam(), domain(), "1000"});
    EXPECT_EQ(rtd.wait(std::chrono::seconds(2 * seconds() + 60)), 0) << rtd.output();
    if (attacked) {
      ::kill(static_cast<pid_t>(attacker.process()), SIGTERM);
      attacker.wait();
    }
    EXPECT_THAT(rtd.output(), Not(HasSubstr(" died"))) << "no service ends";
    EXPECT_THAT(rtd.output(), Not(HasSubstr("\x1b[2J"))) << "nothing of the attacker reaches the terminal as it is";
    const nlohmann::json report = nlohmann::json::parse(text_of(out + "/report.json"));
    return {report["frames_tracked"], report["frames_in"], report["ate_rmse_m"], attacker.output()};
  }

  ScratchFolder scratch_;
};

TEST_P(FloodTest, costs_the_real_camera_at_most_a_tenth_of_its_poses_and_no_accuracy) {
  const Outcome quiet = run(false), attacked = run(true);
  std::cout << "quiet: " << quiet.poses << " of " << quiet.frames << " frames, ATE " << quiet.ate_m
            << " m; attacked: " << attacked.poses << " of " << attacked.frames << ", ATE " << attacked.ate_m << " m, "
            << attacked.written;
  EXPECT_THAT(attacked.written, HasSubstr("messages written"));
  EXPECT_EQ(attacked.frames, quiet.frames) << "forged frames count nowhere";
  if (test_support::kSanitized) GTEST_SKIP() << test_support::kTooSlow;
  const bool judged = seconds() >= 60;
  EXPECT_GE(attacked.poses, (judged ? 0.9 : 0.75) * quiet.poses);
  EXPECT_LE(attacked.ate_m, (judged ? 1.2 : 2) * quiet.ate_m + 0.001);
}

INSTANTIATE_TEST_SUITE_P(Vendors, FloodTest, testing::ValuesIn(bus::dds_vendors()));

}  // namespace
}  // namespace rtd::launcher
