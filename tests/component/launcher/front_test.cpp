// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <signal.h>

#include <fstream>
#include <regex>
#include <sstream>
#include <thread>

#include "common/msg/engine_names.hpp"
#include "tests/component/launcher/rtd_command.hpp"

namespace rtd::launcher {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

/// The command line of `rtd` itself, with a script as the only service beside it.
class FrontTest : public testing::Test {
 protected:
  FrontTest() {
    fs::copy_file(RTD_EXECUTABLE, scratch_ / "rtd");
    std::ofstream(scratch_ / "rtd-echo") << "#!/bin/sh\necho \"echo got: $*\"\nexit 7\n";
    fs::permissions(scratch_ / "rtd-echo", fs::perms::owner_all);
  }
  ScratchFolder scratch_;
  RtdCommand rtd_{scratch_ / "rtd"};
};

TEST_F(FrontTest, help_names_commands_and_installed_services) {
  EXPECT_EQ(rtd_.run({"--help"}), 0);
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("run"), HasSubstr("demo"), HasSubstr("eval"), HasSubstr("doctor"),
                                   HasSubstr("rtd echo")));
}

TEST_F(FrontTest, without_arguments_and_as_the_command_help_it_prints_all_commands) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{}, {"help"}}) {
    RtdCommand rtd(scratch_ / "rtd");
    EXPECT_EQ(rtd.run(arguments), 0);
    EXPECT_THAT(rtd.output(), AllOf(HasSubstr("Commands:"), HasSubstr("Tools:"), HasSubstr("Services:")));
  }
}

TEST_F(FrontTest, help_of_a_run_names_every_engine_of_the_detector) {
  EXPECT_EQ(rtd_.run({"run", "--help"}), 0);
  EXPECT_THAT(std::regex_replace(rtd_.output(), std::regex("\\s+"), " "), HasSubstr(msg::kEngineNames));
}

TEST_F(FrontTest, help_of_a_run_is_grouped_and_fits_a_terminal) {
  EXPECT_EQ(rtd_.run({"run", "--help"}), 0);
  std::istringstream lines(rtd_.printed());
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
  for (const char* group : {"Source:", "Results:", "Map:", "Robot:", "Network:", "Security:", "Advanced:", "Examples:"})
    EXPECT_THAT(rtd_.output(), HasSubstr(group));
}

/// What bash asks the function of deploy/completion for, at the end of `line`.
TEST_F(FrontTest, the_tab_key_completes_commands_options_and_schemes) {
  const auto completed = [this](const std::string& line) {
    RtdCommand bash("/bin/bash");
    const std::string typed = (scratch_ / "rtd") + line;
    bash.run({"-c", ". " RTD_COMPLETION "; COMP_LINE='" + typed + "' COMP_POINT=" + std::to_string(typed.size()) +
                        "; _rtd 2>/dev/null; echo \"${COMPREPLY[@]}\""});
    return bash.output();
  };
  EXPECT_EQ(completed(" do"), "doctor\n");
  EXPECT_EQ(completed(" run --pac"), "--pace\n");
  EXPECT_EQ(completed(" run --pace "), "realtime asap lockstep\n");
  EXPECT_EQ(completed(" run --source rea"), "realsense-dds:\n");
  EXPECT_EQ(completed(" run --source tum:"), "\n") << "file names";
}

TEST_F(FrontTest, prints_its_version) {
  EXPECT_EQ(rtd_.run({"version"}), 0);
  EXPECT_THAT(rtd_.output(), testing::MatchesRegex("rtd [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST_F(FrontTest, becomes_a_service_with_its_arguments_and_exit_code) {
  EXPECT_EQ(rtd_.run({"echo", "--help", "a b"}), 7);
  EXPECT_EQ(rtd_.output(), "echo got: --help a b\n");
}

TEST_F(FrontTest, a_replay_with_viewer_gives_it_the_same_bus_and_ends_it) {
  const fs::path received = scratch_ / "viewer";
  std::ofstream(scratch_ / "rtd-viewer") << "#!/bin/sh\necho \"$$ $*\" > " << received << ".part\nmv " << received
                                         << ".part " << received << "\nexec sleep 60\n";
  std::ofstream(scratch_ / "rtd-replay") << "#!/bin/sh\nwhile [ ! -e " << received
                                         << " ]; do sleep 0.02; done\necho \"played: $*\"\nexit 3\n";
  for (const char* name : {"rtd-viewer", "rtd-replay"}) fs::permissions(scratch_ / name, fs::perms::owner_all);
  EXPECT_EQ(rtd_.run({"replay", "a.mcap", "--viewer", "--domain", "9", "--rate", "2", "--set", "viewer.port=81"}), 3);
  EXPECT_EQ(rtd_.output(), "played: a.mcap --domain 9 --rate 2 --set viewer.port=81 --wait-page --hold\n");
  pid_t viewer = 0;
  std::string arguments;
  std::getline(std::ifstream(received) >> viewer, arguments);
  EXPECT_EQ(arguments, " --set viewer.port=81 --domain=9 --log-level warning --open");
  for (int i = 0; i < 2000 && kill(viewer, 0) == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_NE(kill(viewer, 0), 0) << "it still runs";
}

TEST_F(FrontTest, what_viewer_is_to_do_is_passed_on_or_explained) {
  std::ofstream(scratch_ / "rtd-viewer") << "#!/bin/sh\nexec sleep 60\n";
  std::ofstream(scratch_ / "rtd-replay") << "#!/bin/sh\necho \"played: $*\"\n";
  for (const char* name : {"rtd-viewer", "rtd-replay"}) fs::permissions(scratch_ / name, fs::perms::owner_all);
  const auto played = [this](const std::string& option) {
    RtdCommand rtd(scratch_ / "rtd");
    rtd.run({"replay", "a.mcap", option});
    return rtd.output();
  };
  EXPECT_EQ(played("--viewer=now"), "played: a.mcap --hold\n");
  EXPECT_EQ(played("--viewer=exit"), "played: a.mcap --wait-page\n");
  EXPECT_EQ(played("--viewer=now,exit"), "played: a.mcap\n");
  EXPECT_THAT(played("--viewer=later"), HasSubstr("--viewer=now (no wait)"));
  EXPECT_EQ(rtd_.run({"run", "--source", "synthetic:office", "--out", scratch_ / "out", "--viewer=later"}), 2);
  EXPECT_THAT(rtd_.output(), HasSubstr("--viewer=now (no wait)"));
}

TEST_F(FrontTest, a_replay_without_the_viewer_that_it_is_to_have_does_not_start) {
  std::ofstream(scratch_ / "rtd-replay") << "#!/bin/sh\necho played\n";
  fs::permissions(scratch_ / "rtd-replay", fs::perms::owner_all);
  EXPECT_EQ(rtd_.run({"replay", "a.mcap", "--viewer"}), 2);
  EXPECT_THAT(rtd_.output(), HasSubstr("--target rtd-viewer"));
}

TEST_F(FrontTest, what_is_wrong_is_exit_code_2_with_the_fix) {
  const std::string out = scratch_ / "out";
  const auto run_with = [&out](const std::string& option, const std::string& value) {
    return std::vector<std::string>{"run", "--source", "synthetic:office", "--out", out, option, value};
  };
  const std::pair<std::vector<std::string>, std::vector<std::string>> wrong[] = {
      {{"ehco"}, {"'ehco' is not an rtd command, did you mean 'echo'?"}},
      {{"topics", "list"}, {"--target rtd-topics"}},
      {run_with("--detector", "remote"), {"--profile lan"}},
      {run_with("--profile", "lna"), {"lan, localhost, secure, wifi"}},
      {run_with("--model", "/no/such.onnx"), {"/no/such.onnx"}},
      {{"run", "--source", "synthetic:office", "--out", "/proc/nowhere"}, {"--out /proc/nowhere: cannot be created"}},
      {{"run", "--sorce", "synthetic:office", "--out", out}, {"--sorce", "did you mean --source"}}};
  for (const auto& [arguments, words] : wrong) {
    RtdCommand rtd(scratch_ / "rtd");
    EXPECT_EQ(rtd.run(arguments), 2) << arguments.back();
    for (const std::string& word : words) EXPECT_THAT(rtd.output(), HasSubstr(word)) << arguments.back();
  }
}

TEST_F(FrontTest, passes_the_name_on_to_an_executable_with_several_commands) {
  fs::copy_file(scratch_ / "rtd-echo", scratch_ / "rtd-recording");
  EXPECT_EQ(rtd_.run({"info", "a.mcap"}), 7);
  EXPECT_EQ(rtd_.output(), "echo got: info a.mcap\n");
}

TEST_F(FrontTest, signals_of_a_command_pass_through) {
  std::ofstream(scratch_ / "rtd-map") << "#!/bin/sh\nkill -TERM $$\n";
  fs::permissions(scratch_ / "rtd-map", fs::perms::owner_all);
  EXPECT_EQ(rtd_.run({"map", "info"}), -SIGTERM);
}

TEST_F(FrontTest, wrong_usage_is_exit_code_2) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"run"},
                                             {"run", "--source", "synthetic:office"},
                                             {"run", "--source", "x", "--out", "y", "--pace", "fast"},
                                             {"eval", "only_one"},
                                             {"--nonsense"}}) {
    EXPECT_EQ(rtd_.run(arguments), 2) << arguments.back();
  }
}

TEST_F(FrontTest, bad_input_of_a_run_is_exit_code_2_and_leaves_no_folder) {
  for (const char* source : {"tum:/nonexistent", "nonsense", "film:x", "synthetic:nowhere", "v4l2:/dev/video0"}) {
    EXPECT_EQ(rtd_.run({"run", "--source", source, "--out", scratch_ / "out"}), 2) << source;
    EXPECT_FALSE(fs::exists(scratch_ / "out")) << source;
  }
}

TEST_F(FrontTest, motion_topics_that_a_recording_does_not_have_are_refused_with_those_it_has) {
  const char* const data = std::getenv("RTD_DATA_DIR");
  const std::string file = std::string(data == nullptr ? "" : data) + "/field/recording_with_imu_and_tf/imu_tf.mcap";
  if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
  EXPECT_EQ(rtd_.run({"run", "--source", "mcap:" + file, "--imu", "/other", "--out", scratch_ / "out"}), 2);
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("--imu /other"), HasSubstr("/camera/imu (sensor_msgs/Imu")));
}

TEST_F(FrontTest, the_doctor_names_every_missing_service_and_fails) {
  EXPECT_EQ(rtd_.run({"doctor"}), 1);
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("FAIL services: missing rtd-camera rtd-detector rtd-filter rtd-slam"),
                                   HasSubstr("bus: "), HasSubstr("weights: "), HasSubstr("data: ")));
}

}  // namespace
}  // namespace rtd::launcher
