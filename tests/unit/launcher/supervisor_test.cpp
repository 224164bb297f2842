// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/launcher/core/run/supervisor.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "tests/unit/launcher/fake_host.hpp"

namespace rtd::launcher {
namespace {

using std::chrono::milliseconds;
using namespace ::testing;

class SupervisorTest : public testing::Test {
 protected:
  void start_all() {
    supervisor.start({"slam", {"rtd-slam"}, ServiceRole::kEssential}, now);
    supervisor.start({"detector", {"rtd-detector"}, ServiceRole::kOptional}, now);
    supervisor.start({"camera", {"rtd-camera"}, ServiceRole::kSource}, now);
  }
  /// With many looks on the way, as in a run.
  void advance(milliseconds by) {
    constexpr milliseconds kLook{500};
    for (; by > kLook; by -= kLook) supervisor.update(now += kLook);
    supervisor.update(now += by);
  }
  /// Everything is stopped, the launcher too.
  void stand_still(milliseconds by) { supervisor.update(now += by); }
  void die(const std::string& name, process::ProcessExit exit) {
    host.end(name, exit);
    advance(milliseconds(10));
  }
  void die_and_wait(const std::string& name, int times) {
    for (int i = 0; i < times; ++i) {
      die(name, {1, 0});
      advance(milliseconds(2000));
    }
  }
  long restarts(const std::string& name) const { return std::ranges::count(host.started, name) - 1; }

  FakeHost host;
  std::vector<std::string> reported;
  milliseconds now{1000};
  Supervisor supervisor{host, SupervisorOptions{}, [this](const SupervisorEvent& e) { reported.push_back(e.text); }};
};

TEST_F(SupervisorTest, one_that_falls_silent_is_killed_and_restarted_at_once) {
  start_all();
  advance(milliseconds(5000));
  host.signs["slam"] = 1;
  advance(milliseconds(100));
  advance(milliseconds(2900));
  host.signs["slam"] = 2;
  advance(milliseconds(90));
  advance(milliseconds(2990));
  EXPECT_THAT(host.killed, IsEmpty());
  advance(milliseconds(10));
  EXPECT_THAT(host.killed, ElementsAre("slam"));
  advance(milliseconds(10));
  EXPECT_THAT(reported, Contains("slam hung for 3 s and was killed, restart at once"));
  EXPECT_EQ(restarts("slam"), 1);
  EXPECT_THAT(restarts("detector"), 0) << "has never given a sign of life";
}

TEST_F(SupervisorTest, one_that_gets_no_processor_is_given_more_time) {
  start_all();
  host.signs["slam"] = host.signs["detector"] = 1;
  advance(milliseconds(10));
  for (int i = 0; i < 280; ++i) {
    host.waited["slam"] += milliseconds(70);      // of 100
    host.waited["detector"] += milliseconds(30);  // most of the time it waits for something else
    advance(milliseconds(100));
  }
  EXPECT_THAT(host.killed, AllOf(Contains("detector"), Not(Contains("slam"))));
  host.waited["slam"] += milliseconds(1400);
  advance(milliseconds(2100));
  EXPECT_THAT(host.killed, Contains("slam")) << "not for ever";
}

TEST_F(SupervisorTest, a_camera_that_gave_up_before_its_first_frame_is_not_started_again) {
  bool served = false;
  const auto camera = [&served] {
    return ServicePlan{"camera", {"rtd-camera"}, ServiceRole::kLive, 0, false, {}, [&served] { return served; }};
  };
  supervisor.start(camera(), now);
  served = true;
  die("camera", {1, 0});
  advance(milliseconds(2000));
  EXPECT_EQ(restarts("camera"), 1) << "it gave frames";
  served = false;
  die("camera", {0, 11});
  advance(milliseconds(2000));
  EXPECT_EQ(restarts("camera"), 2) << "a crash is no decision of the camera";
  host.end("camera", {1, 0});
  advance(milliseconds(5000));
  EXPECT_EQ(restarts("camera"), 2);
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kFailed);
  EXPECT_THAT(reported, Contains("camera died: exit code 1 before its first frame: not started again"));
}

TEST_F(SupervisorTest, no_service_is_killed_for_the_time_in_which_everything_stood_still) {
  start_all();
  host.signs["slam"] = 1;
  advance(milliseconds(2900));
  for (const milliseconds pause : {milliseconds(10'000), milliseconds(60'000)}) {
    stand_still(pause);
    EXPECT_THAT(host.killed, IsEmpty()) << "each has its time from before the pause";
    ++host.signs["slam"];
    advance(milliseconds(2900));
    EXPECT_THAT(host.killed, IsEmpty());
  }
  advance(milliseconds(700));
  EXPECT_THAT(host.killed, ElementsAre("slam")) << "a real silence counts as before";
}

TEST_F(SupervisorTest, one_that_was_asked_to_end_has_its_grace_beside_a_standstill) {
  start_all();
  host.unresponsive.insert("slam");
  advance(milliseconds(10));
  supervisor.stop(now, milliseconds(5000), RunOutcome::kInterrupted);
  advance(milliseconds(1000));
  stand_still(milliseconds(10'000));
  EXPECT_THAT(host.killed, IsEmpty());
  advance(milliseconds(4000));
  EXPECT_THAT(host.killed, ElementsAre("slam"));
}

TEST_F(SupervisorTest, the_restarted_one_is_waited_for_as_the_first_was) {
  start_all();
  host.signs["slam"] = 1;
  advance(milliseconds(0));
  advance(milliseconds(5000));
  host.signs["slam"] = 0;  // of the new process
  advance(milliseconds(10));
  advance(milliseconds(60'000));
  EXPECT_EQ(restarts("slam"), 1);
}

TEST_F(SupervisorTest, one_whose_bus_alone_does_not_end_is_not_blamed) {
  start_all();
  host.signs["slam"] = host.signs["detector"] = 1;
  host.unresponsive = {"slam", "detector"};
  advance(milliseconds(10));
  supervisor.stop(now, milliseconds(2000), RunOutcome::kInterrupted);
  host.signs["slam"] = 0;  // it says that it ends
  advance(milliseconds(3000));
  EXPECT_THAT(reported, Contains("slam had done its work, but its bus did not end: killed"));
  EXPECT_THAT(reported, Contains("detector did not end when asked and was killed"));
}

TEST_F(SupervisorTest, the_end_of_the_source_and_a_refused_start_end_the_run) {
  struct Row {
    const char* service;
    process::ProcessExit exit;
    RunOutcome outcome;
  };
  for (const auto& [service, exit, outcome] :
       {Row{"camera", {0, 0}, RunOutcome::kComplete}, Row{"camera", {1, 0}, RunOutcome::kFailed},
        Row{"camera", {0, 6}, RunOutcome::kFailed}, Row{"slam", {2, 0}, RunOutcome::kConfigError},
        Row{"slam", {4, 0}, RunOutcome::kConfigError}}) {  // 4: it runs already
    FakeHost alone;
    Supervisor started{alone, {}, [](const auto& e) { EXPECT_THAT(e.text, Not(HasSubstr("SIGTERM"))); }};
    for (const char* name : {"slam", "camera"})
      started.start({name, {name}, *name == 's' ? ServiceRole::kEssential : ServiceRole::kSource}, now);
    alone.end(service, exit);
    started.update(now);
    started.stop(now, milliseconds(9000), outcome);
    alone.end(*service == 's' ? "camera" : "slam", {0, SIGTERM});
    for (int i = 1; i < 8; ++i) started.update(now + i * milliseconds(400));
    EXPECT_EQ(started.outcome(), outcome) << service << exit.code << exit.signal;
    EXPECT_EQ(alone.started.size(), 2U) << "not tried again";
  }
}

TEST_F(SupervisorTest, a_source_that_crashes_continues_where_it_can_and_one_that_gives_up_does_not) {
  ServicePlan camera{"camera", {"rtd-camera"}, ServiceRole::kSource};
  camera.when_restarted = [] { return std::vector<std::string>{"--resume-after", "20,1,2"}; };
  supervisor.start(camera, now);
  advance(milliseconds(6000));
  die("camera", {0, 6});
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kRunning);
  EXPECT_THAT(host.arguments, ElementsAre("--resume-after", "20,1,2"));
  host.end("camera", {1, 0});
  advance(milliseconds(3000));
  EXPECT_EQ(restarts("camera"), 1);
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kFailed);
}

TEST_F(SupervisorTest, restarts_a_live_camera_that_dies_and_ends_with_one_that_ends) {
  supervisor.start({"camera", {"rtd-camera"}, ServiceRole::kLive}, now);
  advance(milliseconds(6000));
  die("camera", {0, 9});
  EXPECT_EQ(restarts("camera"), 1);
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kRunning);
  die("camera", {0, 0});
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kComplete);
}

TEST_F(SupervisorTest, fails_when_a_live_camera_keeps_dying) {
  supervisor.start({"camera", {"rtd-camera"}, ServiceRole::kLive}, now);
  die_and_wait("camera", 6);
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kFailed);
}

TEST_F(SupervisorTest, names_service_and_signal_of_a_death_and_restarts_after_the_backoff) {
  start_all();
  die("slam", {0, 11});
  EXPECT_THAT(reported.back(), HasSubstr("slam died: killed by signal 11 (SIGSEGV), restart in 200 ms"));
  advance(milliseconds(199));
  EXPECT_EQ(host.started.size(), 3U);
  advance(milliseconds(1));
  EXPECT_EQ(host.started.back(), "slam");
  EXPECT_EQ(restarts("slam"), 1);
  EXPECT_EQ(restarts("camera"), 0);
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kRunning);
}

TEST_F(SupervisorTest, restarts_one_that_had_worked_for_long_at_once) {
  start_all();
  advance(milliseconds(6000));
  host.end("slam", {0, 9});
  advance(milliseconds(0));
  EXPECT_THAT(reported, testing::Contains(HasSubstr("slam died: killed by signal 9 (SIGKILL), restart at once")));
  EXPECT_EQ(host.started.back(), "slam");
  EXPECT_EQ(restarts("slam"), 1);
  die("slam", {0, 9});
  EXPECT_THAT(reported.back(), HasSubstr("restart in 400 ms")) << "young: the second of its row";
}

TEST_F(SupervisorTest, a_worker_is_restarted_whatever_its_exit_code_once_it_had_started) {
  start_all();
  for (const int code : {0, 2}) {
    die("slam", {code, 0});
    advance(milliseconds(2000));
    EXPECT_EQ(supervisor.outcome(), RunOutcome::kRunning);
  }
  EXPECT_EQ(restarts("slam"), 2);
}

TEST_F(SupervisorTest, backoff_doubles_and_is_bounded) {
  start_all();
  for (const char* pause : {"200 ms", "400 ms", "800 ms", "1600 ms", "2000 ms"}) {
    die("slam", {1, 0});
    EXPECT_THAT(reported.back(), HasSubstr(pause));
    advance(milliseconds(2000));
  }
}

TEST_F(SupervisorTest, gives_an_essential_service_up_after_five_restarts_in_a_row) {
  start_all();
  die_and_wait("slam", 5);
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kRunning);
  die_and_wait("slam", 1);
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kFailed);
  EXPECT_EQ(restarts("slam"), 5);
  EXPECT_THAT(reported.back(), HasSubstr("6 times in a row: given up"));
}

TEST_F(SupervisorTest, continues_without_an_optional_service) {
  start_all();
  die_and_wait("detector", 6);
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kRunning);
  EXPECT_THAT(reported.back(), HasSubstr("the run continues without it"));
}

TEST_F(SupervisorTest, a_healthy_life_starts_a_new_row) {
  start_all();
  for (int i = 0; i < 12; ++i) {
    advance(milliseconds(6000));
    die("slam", {1, 0});
    advance(milliseconds(200));
  }
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kRunning);
  EXPECT_EQ(restarts("slam"), 12);
}

TEST_F(SupervisorTest, kills_only_those_that_did_not_end_within_the_grace) {
  host.unresponsive.insert("slam");
  start_all();
  host.signs["slam"] = 1;  // and none after that: one that ends does not hang
  advance(milliseconds(10));
  supervisor.stop(now, milliseconds(20'000), RunOutcome::kInterrupted);
  advance(milliseconds(19'999));
  EXPECT_THAT(host.terminated, ElementsAre("slam", "detector", "camera"));
  EXPECT_TRUE(host.killed.empty());
  EXPECT_FALSE(supervisor.all_ended());
  advance(milliseconds(1));
  EXPECT_THAT(host.killed, ElementsAre("slam"));
  advance(milliseconds(1));
  EXPECT_TRUE(supervisor.all_ended());
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kInterrupted);
}

TEST_F(SupervisorTest, a_stop_cancels_a_due_restart) {
  start_all();
  die("slam", {1, 0});
  supervisor.stop(now, milliseconds(1200), RunOutcome::kInterrupted);
  advance(milliseconds(2000));
  EXPECT_EQ(host.started.size(), 3U);
  EXPECT_TRUE(supervisor.all_ended());
}

TEST_F(SupervisorTest, a_second_stop_keeps_the_first_outcome_and_the_shorter_grace) {
  host.unresponsive.insert("slam");
  start_all();
  supervisor.stop(now, milliseconds(5000), RunOutcome::kComplete);
  supervisor.stop(now, milliseconds(100), RunOutcome::kInterrupted);
  advance(milliseconds(100));
  EXPECT_THAT(host.killed, ElementsAre("slam"));
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kComplete);
}

TEST_F(SupervisorTest, who_ends_last_is_asked_when_the_others_have_ended) {
  supervisor.start({"record", {"rtd-record"}, ServiceRole::kOptional, 0, true}, now);
  start_all();
  host.unresponsive = {"slam", "record"};
  supervisor.stop(now, milliseconds(1200), RunOutcome::kComplete);
  EXPECT_THAT(host.terminated, ElementsAre("slam", "detector", "camera"));
  advance(milliseconds(1000));
  EXPECT_THAT(host.terminated, ElementsAre("slam", "detector", "camera")) << "slam still works";
  die("slam", {});
  EXPECT_THAT(host.terminated, ElementsAre("slam", "detector", "camera", "record"));
  advance(milliseconds(1000));
  EXPECT_THAT(host.killed, IsEmpty()) << "its own grace";
  advance(milliseconds(250));
  EXPECT_THAT(host.killed, ElementsAre("record"));
  advance(milliseconds(10));
  EXPECT_TRUE(supervisor.all_ended());
}

TEST_F(SupervisorTest, a_second_stop_asks_who_ends_last_too) {
  supervisor.start({"record", {"rtd-record"}, ServiceRole::kOptional, 0, true}, now);
  start_all();
  host.unresponsive = {"slam"};
  supervisor.stop(now, milliseconds(5000), RunOutcome::kInterrupted);
  supervisor.stop(now, milliseconds(0), RunOutcome::kInterrupted);
  EXPECT_THAT(host.terminated, Contains("record"));
}

const ServicePlan kViewer{.name = "viewer",
                          .command = {"rtd-viewer"},
                          .role = ServiceRole::kOptional,
                          .ends_last = true,
                          .outlives_run = true};

TEST_F(SupervisorTest, who_outlives_the_run_ends_when_asked) {
  supervisor.start(kViewer, now);
  start_all();
  supervisor.stop(now, milliseconds(1000), RunOutcome::kComplete);
  advance(milliseconds(10));
  EXPECT_TRUE(supervisor.all_ended()) << "of the run";
  EXPECT_THAT(host.terminated, Not(Contains("viewer")));
  EXPECT_TRUE(supervisor.rest_runs());
  supervisor.end_rest(now, milliseconds(1000));
  advance(milliseconds(10));
  EXPECT_THAT(host.terminated, Contains("viewer"));
  EXPECT_FALSE(supervisor.rest_runs());
}

TEST_F(SupervisorTest, an_interrupted_run_is_outlived_by_none) {
  supervisor.start(kViewer, now);
  start_all();
  supervisor.stop(now, milliseconds(1000), RunOutcome::kInterrupted);
  advance(milliseconds(10));
  advance(milliseconds(10));
  EXPECT_THAT(host.terminated, Contains("viewer"));
  EXPECT_TRUE(supervisor.all_ended());
}

TEST_F(SupervisorTest, a_restarted_service_gets_the_arguments_of_that_moment) {
  int asked = 0;
  ServicePlan slam{"slam", {"rtd-slam", "--out", "o"}};
  slam.when_restarted = [&asked] { return std::vector<std::string>{"--map", std::to_string(++asked)}; };
  supervisor.start(slam, now);
  EXPECT_THAT(host.arguments, ElementsAre("--out", "o"));
  die_and_wait("slam", 1);
  EXPECT_THAT(host.arguments, ElementsAre("--out", "o", "--map", "1"));
  die_and_wait("slam", 1);
  EXPECT_THAT(host.arguments, ElementsAre("--out", "o", "--map", "2"));
}

TEST_F(SupervisorTest, a_missing_executable_is_reported_to_the_caller_and_later_fails_the_run) {
  host.missing.insert("detector");
  EXPECT_THROW(start_all(), process::ProcessError);
  host.missing = {"slam"};
  die_and_wait("slam", 1);
  EXPECT_EQ(supervisor.outcome(), RunOutcome::kFailed);
  EXPECT_THAT(reported.back(), HasSubstr("could not be restarted"));
}

}  // namespace
}  // namespace rtd::launcher
