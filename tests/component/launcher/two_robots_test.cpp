// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "tests/component/launcher/rtd_command.hpp"

namespace rtd::launcher {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Whole runs of robots with names, on one host and in one DDS domain.
class TwoRobots : public ::testing::TestWithParam<const char*> {
 protected:
  static constexpr const char *kAnnaSees = "synthetic:office?frames=20", *kBertSees = "synthetic:slow?frames=20&seed=2";

  std::vector<std::string> arguments(const std::string& source, const std::string& out,
                                     const std::vector<std::string>& more) const {
    std::vector<std::string> all = {"run",   "--source", source,   "--out",    scratch_ / out, "--domain", "76",
                                    "--dds", GetParam(), "--pace", "lockstep", "--detector",   "off"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  std::string trajectory(const std::string& out) const { return text_of(scratch_ / out + "/trajectory.txt"); }

  ScratchFolder scratch_;
};

TEST_P(TwoRobots, give_the_trajectories_of_their_single_runs_byte_for_byte) {
  RtdCommand anna_alone, bert_alone, anna, bert;
  ASSERT_EQ(anna_alone.run(arguments(kAnnaSees, "anna_alone", {})), 0) << anna_alone.output();
  ASSERT_EQ(bert_alone.run(arguments(kBertSees, "bert_alone", {})), 0) << bert_alone.output();
  ASSERT_NE(trajectory("anna_alone"), trajectory("bert_alone"));

  anna.start(arguments(kAnnaSees, "anna", {"--robot", "anna", "--record", scratch_ / "anna.mcap"}));
  bert.start(arguments(kBertSees, "bert", {"--robot", "bert"}));
  ASSERT_EQ(anna.wait(), 0) << anna.output();
  ASSERT_EQ(bert.wait(), 0) << bert.output();
  EXPECT_EQ(trajectory("anna"), trajectory("anna_alone"));
  EXPECT_EQ(trajectory("bert"), trajectory("bert_alone"));

  const std::string recorded = text_of(scratch_ / "anna/logs/record.log");
  EXPECT_THAT(recorded, AllOf(HasSubstr("topic=rtd/anna/frame messages=20"), HasSubstr("topic=/anna/slam/odometry"),
                              HasSubstr("topic=/tf "), Not(HasSubstr("bert"))));

  RtdCommand again;  // the robot's name is in the recording
  const std::string file = "mcap:" + (scratch_ / "anna.mcap");
  ASSERT_EQ(again.run(arguments(file, "again", {"--replay-topics", "features"})), 0) << again.output();
  EXPECT_EQ(trajectory("again"), trajectory("anna_alone"));
  RtdCommand as_bert;
  ASSERT_EQ(as_bert.run(arguments(file, "as_bert", {"--replay-topics", "features", "--robot", "bert"})), 0)
      << as_bert.output();
  EXPECT_EQ(trajectory("as_bert"), trajectory("anna_alone"));
}

TEST_P(TwoRobots, of_one_name_are_refused) {
  RtdCommand first, second, third;
  first.start(arguments("synthetic:office?frames=0", "first", {"--robot", "anna"}));
  ASSERT_TRUE(first.wait_for("inliers")) << first.output();
  EXPECT_EQ(second.run(arguments(kAnnaSees, "second", {"--robot", "anna"})), 2) << second.output();
  EXPECT_THAT(second.output(), HasSubstr("robot 'anna' in DDS domain 76 has"));
  EXPECT_EQ(third.run(arguments(kAnnaSees, "third", {"--robot", "bert"})), 0) << third.output();
  first.interrupt();
  EXPECT_EQ(first.wait(), 130) << first.output();
}

TEST_P(TwoRobots, a_name_that_ros_would_refuse_is_refused) {
  RtdCommand rtd;
  EXPECT_EQ(rtd.run(arguments(kAnnaSees, "out", {"--robot", "anna/1"})), 2);
  EXPECT_THAT(rtd.output(), HasSubstr("'anna/1' cannot be a robot's name"));
}

INSTANTIATE_TEST_SUITE_P(Vendors, TwoRobots, ::testing::Values("fastdds", "cyclonedds"));

}  // namespace
}  // namespace rtd::launcher
