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
  std::string written;      ///< by the attacker
  bool maps_rings = false;  ///< the launcher
};

/// A running pipeline in real time, and a peer without keys that writes to every topic and command a thousand times a
/// second, or without a pause by writers that come and go. RTD_FLOOD_S makes the attack longer than
/// six seconds; 60 and more are judged by the asked figures, six leave room for a busy computer.
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

  /// `rate_hz`: of the attack, empty: none.
  Outcome run(const std::string& rate_hz) {
    const bool attacked = !rate_hz.empty();
    const std::string out = scratch_ / (attacked ? "attacked" + rate_hz : "quiet");
    RtdCommand rtd, attacker(FLOOD_PEER_PATH);
    rtd.start(arguments(out));
    EXPECT_TRUE(rtd.wait_for(" fps ")) << rtd.output();  // the first source of a topic is followed
    if (attacked) attacker.start({GetParam(), domain(), rate_hz});
    rtd.wait_for("never printed", std::chrono::seconds(1));
    const std::string maps = text_of("/proc/" + std::to_string(rtd.process()) + "/maps");
    EXPECT_EQ(rtd.wait(std::chrono::seconds(2 * seconds() + 60)), 0) << rtd.output();
    if (attacked) {
      ::kill(static_cast<pid_t>(attacker.process()), SIGTERM);
      attacker.wait();
    }
    EXPECT_THAT(rtd.output(), Not(HasSubstr(" died"))) << "no service ends";
    EXPECT_THAT(rtd.output(), Not(HasSubstr("\x1b[2J"))) << "nothing of the attacker reaches the terminal as it is";
    const nlohmann::json report = nlohmann::json::parse(text_of(out + "/report.json"));
    return {report["frames_tracked"], report["frames_in"], report["ate_rmse_m"], attacker.output(),
            maps.find("fast_datasharing_") != std::string::npos};
  }

  ScratchFolder scratch_;
};

TEST_P(FloodTest, costs_the_real_camera_at_most_a_tenth_of_its_poses_and_no_accuracy) {
  const Outcome quiet = run(""), attacked = run("1000");
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

TEST_P(FloodTest, by_writers_that_come_and_go_ends_nothing_and_the_launcher_maps_no_ring) {
  const Outcome attacked = run("0");
  std::cout << attacked.poses << " of " << attacked.frames << " frames, " << attacked.written;
  EXPECT_THAT(attacked.written, HasSubstr("messages written"));
  EXPECT_FALSE(attacked.maps_rings);
  if (test_support::kSanitized) GTEST_SKIP() << test_support::kTooSlow;
  EXPECT_GE(attacked.poses, (seconds() >= 60 ? 0.95 : 0.75) * 30 * seconds());
}

INSTANTIATE_TEST_SUITE_P(Vendors, FloodTest, testing::ValuesIn(bus::dds_vendors()));

}  // namespace
}  // namespace rtd::launcher
