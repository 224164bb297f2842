// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/test_domain.hpp"
#include "tests/support/time_bounds.hpp"

namespace rtd::launcher {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// `rtd run` with shell scripts in the place of the services: what it does with processes, whatever they compute.
class SupervisedRunTest : public testing::Test {
 protected:
  SupervisedRunTest() {
    fs::create_directories(scratch_ / "bin");
    fs::copy_file(RTD_EXECUTABLE, scratch_ / "bin/rtd");  // services are looked for beside it
    fs::create_symlink(RTD_EVAL_EXECUTABLE, scratch_ / "bin/rtd-eval");
    script("detector", kServe);
    script("filter", kServe);
    script("slam", kServe);
    script("camera", "exit 0");
  }
  void script(const std::string& service, const std::string& text) {
    const std::string path = scratch_ / ("bin/rtd-" + service);
    std::ofstream(path) << "#!/bin/sh\n" << text << '\n';
    fs::permissions(path, fs::perms::owner_all);
  }
  std::vector<std::string> arguments(const std::vector<std::string>& more = {}) {
    std::vector<std::string> all = {"run",
                                    "--source",
                                    "synthetic:office?frames=5",
                                    "--out",
                                    scratch_ / "out",
                                    "--dds",
                                    "cyclonedds",
                                    "--filter",
                                    "geometry",
                                    "--set",
                                    "launcher.connect_timeout_ms=0",
                                    "--set",
                                    "launcher.domain_check_ms=0"};
    if (std::ranges::count(more, "--domain") == 0) all.insert(all.end(), {"--domain", std::to_string(test_domain())});
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  std::string log(const std::string& service) { return text_of(scratch_ / ("out/logs/" + service + ".log")); }

  static constexpr char kServe[] = "trap 'exit 0' TERM; while :; do sleep 0.05; done";
  ScratchFolder scratch_;
  RtdCommand rtd_{scratch_ / "bin/rtd"};
};

TEST_F(SupervisedRunTest, gives_every_service_its_arguments_and_a_log) {
  for (const char* service : {"filter", "slam"}) script(service, std::string("echo \"$@\"; ") + kServe);
  script("camera", "echo \"$@\"; sleep 0.3");
  rtd_.run(arguments({"--pace", "lockstep", "--domain", "7", "--frames", "3", "--set", "slam.x=1"}));
  EXPECT_THAT(log("filter"),
              AllOf(HasSubstr("--pace lockstep"), HasSubstr("--dds=cyclonedds --domain=7"), HasSubstr("--set slam.x=1"),
                    HasSubstr("--filter=geometry --set filter.detector=off")));
  EXPECT_THAT(log("slam"), HasSubstr("--out " + (scratch_ / "out")));
  EXPECT_THAT(log("camera"), AllOf(HasSubstr("--source synthetic:office?frames=5"), HasSubstr("--frames 3"),
                                   HasSubstr("--wait-for filter,slam"), Not(HasSubstr("detector"))));
  EXPECT_FALSE(fs::exists(scratch_ / "out/logs/detector.log")) << "geometry needs no detector";
}

TEST_F(SupervisedRunTest, looks_for_no_other_run_where_no_process_is_in_the_domain) {
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(rtd_.run(arguments({"--domain", "79", "--set", "launcher.domain_check_ms=10000"})), 1);
  if (test_support::checks_time()) {
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(9));
  }
}

TEST_F(SupervisedRunTest, a_run_without_a_pose_fails_and_says_so) {
  EXPECT_EQ(rtd_.run(arguments()), 1);
  EXPECT_THAT(rtd_.output(), HasSubstr("no frame got a pose"));
  EXPECT_TRUE(fs::exists(scratch_ / "out/report.json"));
  EXPECT_TRUE(fs::exists(scratch_ / "out/report.html"));
}

TEST_F(SupervisedRunTest, without_rtd_eval_it_keeps_the_data_and_names_the_fix) {
  fs::remove(scratch_ / "bin/rtd-eval");
  setenv("PATH", "/usr/bin:/bin", 1);
  EXPECT_EQ(rtd_.run(arguments()), 1);
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("no report: rtd-eval is neither next to rtd"),
                                   HasSubstr("then run 'rtd report " + (scratch_ / "out")), HasSubstr("no frame got")));
  EXPECT_FALSE(fs::exists(scratch_ / "out/report.json"));
  RtdCommand later(RTD_EVAL_EXECUTABLE);
  EXPECT_EQ(later.run({"report", scratch_ / "out"}), 0) << later.output();
  EXPECT_TRUE(fs::exists(scratch_ / "out/report.json"));
}

TEST_F(SupervisedRunTest, a_report_that_cannot_be_made_fails_the_run) {
  fs::remove(scratch_ / "bin/rtd-eval");
  script("eval", "echo 'rtd report: disk full' >&2; exit 1");
  EXPECT_EQ(rtd_.run(arguments()), 1);
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("rtd report: disk full"), HasSubstr("rtd-eval: exit code 1"),
                                   HasSubstr("out/run.json has the data of the run")));
}

TEST_F(SupervisedRunTest, ctrl_c_while_the_report_is_made_is_passed_on) {
  fs::remove(scratch_ / "bin/rtd-eval");
  script("eval", "echo judging > " + (scratch_ / "judging") +
                     "; exec python3 -c 'import signal; signal.sigwait({signal.SIGTERM}); print(\"stopped early\")'");
  rtd_.start(arguments());
  while (!fs::exists(scratch_ / "judging")) usleep(10'000);
  rtd_.interrupt();  // before it reads signals
  EXPECT_EQ(rtd_.wait(), 1) << "the run itself had ended without a pose";
  EXPECT_THAT(rtd_.output(), HasSubstr("stopped early"));
}

TEST_F(SupervisedRunTest, a_second_ctrl_c_ends_the_report_and_names_its_command) {
  fs::remove(scratch_ / "bin/rtd-eval");
  script("eval", "echo judging > " + (scratch_ / "judging") + "; while :; do sleep 0.05; done");
  rtd_.start(arguments());
  while (!fs::exists(scratch_ / "judging")) usleep(10'000);
  rtd_.interrupt();
  rtd_.wait_for("never printed", std::chrono::milliseconds(200));
  rtd_.interrupt();
  EXPECT_EQ(rtd_.wait(), 1);
  EXPECT_THAT(rtd_.output(), HasSubstr("'rtd report " + (scratch_ / "out") + "' makes it"));
}

TEST_F(SupervisedRunTest, one_ctrl_c_while_the_report_is_made_ends_the_viewer_too) {
  fs::remove(scratch_ / "bin/rtd-eval");
  script("eval", "echo judging > " + (scratch_ / "judging") +
                     "; exec python3 -c 'import signal; signal.sigwait({signal.SIGTERM})'");
  script("viewer",
         "echo 'viewer: http://localhost:1'; trap 'echo asked to end; exit 0' TERM; while :; do sleep 0.05; done");
  rtd_.start(arguments({"--viewer=now"}));
  while (!fs::exists(scratch_ / "judging")) usleep(10'000);
  rtd_.interrupt();
  EXPECT_EQ(rtd_.wait(), 1) << "the run itself had ended without a pose";
  EXPECT_THAT(log("viewer"), HasSubstr("asked to end"));
  EXPECT_THAT(rtd_.output(), Not(HasSubstr("the page stays")));
}

TEST_F(SupervisedRunTest, a_refused_configuration_ends_the_run_with_the_services_own_words) {
  script("camera", kServe);
  script("filter", "echo \"rtd-filter: --set: unknown key 'filter.mod', did you mean 'filter.mode'?\" >&2; exit 2");
  EXPECT_EQ(rtd_.run(arguments()), 2);
  EXPECT_THAT(rtd_.output(), HasSubstr("did you mean 'filter.mode'?"));
  EXPECT_FALSE(fs::exists(scratch_ / "out/report.json")) << "nothing ran, nothing to report";
}

TEST_F(SupervisedRunTest, a_failed_camera_fails_the_run_with_its_last_words) {
  script("camera", "echo 'rtd-camera: disk on fire' >&2; exit 1");
  EXPECT_EQ(rtd_.run(arguments()), 1);
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("camera died: exit code 1"), HasSubstr("disk on fire")));
}

TEST_F(SupervisedRunTest, a_killed_service_is_named_and_restarted_and_the_others_go_on) {
  const std::string marker = scratch_ / "died";
  script("slam",
         "if [ ! -e " + marker + " ]; then touch " + marker + "; echo last words; kill -KILL $$; fi; " + kServe);
  script("camera", "sleep 1");
  rtd_.run(arguments());
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("slam died: killed by signal 9 (SIGKILL), restart in 200 ms"),
                                   HasSubstr("| last words"), HasSubstr("slam restarted (1st time)")));
  EXPECT_THAT(rtd_.output(), Not(HasSubstr("filter died")));
}

TEST_F(SupervisedRunTest, a_camera_of_this_host_that_is_not_there_ends_the_run_before_anything_starts) {
  std::vector<std::string> local = arguments();
  local[2] = "openni2:1d27/0609@250/250";
  ::setenv("ASAN_OPTIONS", "detect_leaks=0", 1);  // OpenNI's drivers are unloaded with what they hold
  EXPECT_EQ(rtd_.run(local), 2);
  ::unsetenv("ASAN_OPTIONS");
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("--source 'openni2:1d27/0609@250/250'"), HasSubstr("'rtd doctor' says")));
  EXPECT_FALSE(fs::exists(scratch_ / "out/logs/slam.log"));
}

TEST_F(SupervisedRunTest, a_camera_that_never_gave_a_frame_is_not_restarted) {
  script("camera", "echo 'no frame within 30 s' >&2; exit 1");
  std::vector<std::string> endless = arguments();
  endless[2] = "synthetic:office?frames=0";
  EXPECT_EQ(rtd_.run(endless), 1);
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("before its first frame: not started again"),
                                   HasSubstr("no frame within 30 s"), Not(HasSubstr("camera restarted"))));
}

TEST_F(SupervisedRunTest, a_camera_that_crashed_is_started_again_as_the_same_source) {
  for (const char* source : {"synthetic:office?frames=0", "synthetic:office?frames=5"}) {
    const std::string marker = scratch_ / "died";
    fs::remove(marker);
    script("camera", "echo \"$@\"; if [ ! -e " + marker + " ]; then touch " + marker + "; kill -ABRT $$; fi");
    std::vector<std::string> run = arguments();
    run[2] = source;
    rtd_.run(run);
    std::smatch id;
    const std::string given = log("camera");
    ASSERT_TRUE(std::regex_search(given, id, std::regex("--source-id ([1-9][0-9]*)"))) << given;
    EXPECT_THAT(given, HasSubstr("--source-id " + id.str(1) + " --wait-for none,filter,slam,launcher\n"));
  }
}

TEST_F(SupervisedRunTest, a_crashed_service_is_restarted_and_the_report_says_why) {
  const std::string marker = scratch_ / "crashed";
  script("filter", "if [ ! -e " + marker + " ]; then touch " + marker + "; kill -SEGV $$; fi; " + kServe);
  script("camera", "sleep 1");
  rtd_.run(arguments());
  for (const std::string& reported : {rtd_.output(), text_of(scratch_ / "out/report.json")})
    EXPECT_THAT(reported, AllOf(HasSubstr("filter died: killed by signal 11 (SIGSEGV), restart in 200 ms"),
                                HasSubstr("filter restarted (1st time)")));
  EXPECT_THAT(rtd_.output(), HasSubstr("died        filter died: killed by signal 11 (SIGSEGV)\n"));
  EXPECT_THAT(text_of(scratch_ / "out/report.json"), HasSubstr("\"filter died: killed by signal 11 (SIGSEGV)\""));
}

TEST_F(SupervisedRunTest, services_are_restarted_although_the_output_of_the_run_is_not_read) {
  const std::string lives = scratch_ / "lives";
  script("filter", "echo one >> " + lives + "; sleep 0.05; kill -SEGV $$");
  script("camera", "sleep 6");
  std::string line = "exec '" + (scratch_ / "bin/rtd") + "'";
  for (const std::string& argument : arguments({"--set", "launcher.max_restarts=100", "launcher.first_backoff_ms=0"}))
    line += " '" + argument + "'";
  // A pipe that is full but for 512 bytes: dd fills it, and its reader sleeps.
  line = "{ dd if=/dev/zero bs=512 count=127 status=none >&2; " + line + "; } 2>&1 >/dev/null | sleep 10";
  RtdCommand shell("/bin/sh");
  EXPECT_EQ(shell.run({"-c", line}), 0);
  EXPECT_GT(text_of(lives).size(), 20 * std::string("one\n").size());
}

TEST_F(SupervisedRunTest, a_service_that_keeps_dying_fails_the_run) {
  script("slam", "exit 3");
  script("camera", kServe);
  EXPECT_EQ(rtd_.run(arguments({"--set", "launcher.max_restarts=2", "--set", "launcher.first_backoff_ms=10"})), 1);
  EXPECT_THAT(rtd_.output(), HasSubstr("slam died: exit code 3, 3 times in a row: given up"));
}

TEST_F(SupervisedRunTest, ctrl_c_ends_polite_and_unresponsive_services_within_two_seconds) {
  script("camera", kServe);
  script("slam", "trap '' TERM INT; echo unresponsive; while :; do sleep 0.05; done");
  rtd_.start(arguments());
  ASSERT_TRUE(rtd_.wait_for("frame"));
  usleep(300'000);  // the unresponsive one has set its trap

  const auto pressed = std::chrono::steady_clock::now();
  rtd_.interrupt();
  EXPECT_EQ(rtd_.wait(), 130);
  if (test_support::checks_time()) {
    EXPECT_LT(std::chrono::steady_clock::now() - pressed, std::chrono::seconds(2));
  }
  EXPECT_THAT(rtd_.output(),
              AllOf(HasSubstr("slam did not end when asked and was killed"), HasSubstr("partial results")));
  EXPECT_TRUE(fs::exists(scratch_ / "out/report.json"));
}

TEST_F(SupervisedRunTest, ctrl_c_also_reaches_a_run_that_a_shell_put_into_the_background) {
  script("camera", kServe);
  std::string line = "trap '' INT; exec '" + (scratch_ / "bin/rtd") + "'";
  for (const std::string& argument : arguments()) line += " '" + argument + "'";
  RtdCommand shell("/bin/sh");
  shell.start({"-c", line});
  ASSERT_TRUE(shell.wait_for("frame"));
  shell.interrupt();
  EXPECT_EQ(shell.wait(std::chrono::seconds(10)), 130);
}

TEST_F(SupervisedRunTest, quiet_shows_problems_only) {
  script("camera", "echo '12:00:00.000 warning camera event=frame_skipped file=x.png'; sleep 0.3");
  rtd_.run(arguments({"--quiet"}));
  EXPECT_EQ(
      rtd_.output(),
      "  warning camera event=frame_skipped file=x.png\nrtd: no frame got a pose\nrtd: only 0 of 5 frames were used; 5 "
      "x not_played: the run ended before them: the events say why\n");
}

TEST_F(SupervisedRunTest, a_missing_service_is_named_before_anything_starts) {
  fs::remove(scratch_ / "bin/rtd-slam");
  EXPECT_EQ(rtd_.run(arguments()), 2);
  EXPECT_THAT(rtd_.output(), HasSubstr("rtd-slam is neither next to rtd"));
  EXPECT_FALSE(fs::exists(scratch_ / "out/logs/filter.log"));
}

TEST_F(SupervisedRunTest, what_an_earlier_run_left_is_not_taken_for_this_ones) {
  fs::create_directories(scratch_ / "out");
  std::ofstream(scratch_ / "out/trajectory.txt") << "1.0 0 0 0 0 0 0 1\n";
  rtd_.run(arguments());
  EXPECT_FALSE(fs::exists(scratch_ / "out/trajectory.txt"));
}

TEST_F(SupervisedRunTest, has_the_filter_await_the_detector_unless_that_is_off) {
  std::vector<std::string> with_detector = arguments({"--detector", "remote", "--robot", "anna"});
  with_detector.erase(with_detector.begin() + 7, with_detector.begin() + 9);
  script("filter", std::string("echo \"$@\"; ") + kServe);
  script("camera", "sleep 0.3");
  rtd_.run(with_detector);
  EXPECT_THAT(log("filter"), HasSubstr("--set filter.detector=on"));
  with_detector.insert(with_detector.end(), {"--set", "filter.detector=off"});
  rtd_.run(with_detector);
  EXPECT_THAT(log("filter"), AllOf(HasSubstr("filter.detector=off"), Not(HasSubstr("filter.detector=on"))));
}

TEST_F(SupervisedRunTest, without_weights_it_says_so_once_and_runs_on_geometry) {
  setenv("RTD_MODEL_DIR", (scratch_ / "nowhere").c_str(), 1);
  setenv("XDG_CACHE_HOME", (scratch_ / "nowhere").c_str(), 1);
  std::vector<std::string> with_default_filter = arguments();
  with_default_filter.erase(with_default_filter.begin() + 7, with_default_filter.begin() + 9);
  script("filter", std::string("echo \"$@\"; ") + kServe);
  script("camera", "sleep 0.3");
  rtd_.run(with_default_filter);
  EXPECT_THAT(rtd_.output(), HasSubstr("no detector weights"));
  EXPECT_EQ(rtd_.output().find("no detector weights"), rtd_.output().rfind("no detector weights"));
  EXPECT_THAT(log("filter"), HasSubstr("--set filter.detector=off"));
  EXPECT_FALSE(fs::exists(scratch_ / "out/logs/detector.log"));
}

}  // namespace
}  // namespace rtd::launcher
