// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// A lockstep run that is recorded, and the same run from its recording: the real services over Fast DDS.
#include <gmock/gmock.h>

#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/test_domain.hpp"

namespace rtd::replay {
namespace {

using launcher::RtdCommand;
using testing::AllOf;
using testing::HasSubstr;

class ReplayRunTest : public testing::Test {
 protected:
  std::vector<std::string> run(const std::string& source, const std::string& out,
                               const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all = {"run",   "--source", source,     "--out",      out,  "--domain",
                                    domain_, "--pace",   "lockstep", "--detector", "off"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  const std::string domain_ = std::to_string(test_domain());
  launcher::ScratchFolder scratch_;
  const std::string file_ = scratch_ / "run.mcap";
};

TEST_F(ReplayRunTest, replaying_a_lockstep_run_gives_its_trajectory_byte_for_byte) {
  RtdCommand original, from_frames, from_features;
  // The camera waits for a recorder of the run: it misses no frame.
  ASSERT_EQ(original.run(run("synthetic:office?frames=15", scratch_ / "original", {"--record", file_})), 0)
      << original.output();
  const std::string trajectory = launcher::text_of(scratch_ / "original/trajectory.txt");
  ASSERT_GT(std::count(trajectory.begin(), trajectory.end(), '\n'), 10);

  ASSERT_EQ(from_frames.run(run("mcap:" + file_, scratch_ / "frames")), 0) << from_frames.output();
  EXPECT_EQ(launcher::text_of(scratch_ / "frames/trajectory.txt"), trajectory) << "camera: the recording";
  ASSERT_EQ(from_features.run(run("mcap:" + file_, scratch_ / "features", {"--replay-topics", "features"})), 0)
      << from_features.output();
  EXPECT_EQ(launcher::text_of(scratch_ / "features/trajectory.txt"), trajectory) << "camera and filter: the recording";
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "features/logs/filter.log"));

  RtdCommand missing;
  EXPECT_EQ(missing.run(run("mcap:" + file_, scratch_ / "boxes", {"--replay-topics", "detections"})), 2);
  EXPECT_THAT(missing.output(), AllOf(HasSubstr("rt/detector/detections"), HasSubstr("rtd/features")));
}

TEST_F(ReplayRunTest, a_live_source_may_be_a_replay_in_the_same_domain) {
  const std::string camera = scratch_ / "camera.mcap";
  const std::string topics = "ros2:/camera/color/image_raw,/camera/aligned_depth_to_color/image_raw";
  RtdCommand convert, replay, live;
  ASSERT_EQ(convert.run({"convert", "synthetic:office?frames=240&width=320&height=240", camera, "--compress", "lz4"}),
            0)
      << convert.output();
  replay.start({"replay", camera, "--domain", domain_, "--rate", "0.5"});
  ASSERT_TRUE(replay.wait_for("event=recording_opened")) << replay.output();
  EXPECT_EQ(live.run({"run", "--source", topics, "--out", scratch_ / "live", "--domain", domain_, "--detector", "off",
                      "--frames", "10"}),
            0)
      << live.output();
  const std::string trajectory = launcher::text_of(scratch_ / "live/trajectory.txt");
  EXPECT_GT(std::count(trajectory.begin(), trajectory.end(), '\n'), 1);
  replay.interrupt();
  EXPECT_EQ(replay.wait(), 0) << replay.output();
}

TEST_F(ReplayRunTest, a_replay_of_a_runs_own_topics_keeps_the_domain) {
  RtdCommand original, replay, live;
  ASSERT_EQ(original.run(run("synthetic:office?frames=5", scratch_ / "original", {"--record", file_})), 0)
      << original.output();
  replay.start({"replay", file_, "--domain", domain_, "--loop"});
  ASSERT_TRUE(replay.wait_for("event=recording_opened")) << replay.output();
  EXPECT_EQ(live.run(run("ros2:/camera/color/image_raw,/camera/depth/image_raw", scratch_ / "live")), 2);
  EXPECT_THAT(live.output(), AllOf(HasSubstr("is taken by replay"), HasSubstr("--exclude 'rtd/*'")));
  replay.interrupt();
  EXPECT_EQ(replay.wait(), 0) << replay.output();
}

TEST_F(ReplayRunTest, replayed_topics_need_a_recording) {
  RtdCommand rtd;
  EXPECT_EQ(rtd.run(run("synthetic:office", scratch_ / "out", {"--replay-topics", "features"})), 2);
  EXPECT_THAT(rtd.output(), HasSubstr("--source mcap:FILE"));
}

}  // namespace
}  // namespace rtd::replay
