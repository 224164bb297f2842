// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/process/posix_process_host.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>

#include "services/launcher/core/run/supervisor.hpp"

namespace rtd::launcher {
namespace {

using std::chrono::milliseconds;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

milliseconds now() {
  return std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now().time_since_epoch());
}

/// Real processes: small shell scripts.
class PosixProcessHostTest : public testing::Test {
 protected:
  process::ProcessId start(const std::string& name, const std::string& script) {
    return host.start({name, {"/bin/sh", "-c", script}});
  }
  process::ProcessExit wait_for_exit(process::ProcessId process) {
    const milliseconds give_up = now() + milliseconds(10000);
    while (now() < give_up) {
      host.wait(milliseconds(20));
      if (const auto exit = host.poll_exit(process)) return *exit;
    }
    ADD_FAILURE() << "the process did not end";
    return {};
  }
  void wait_for_line(const std::string& name) {
    const milliseconds give_up = now() + milliseconds(10000);
    while (lines[name].empty() && now() < give_up) host.wait(milliseconds(20));
  }

  std::map<std::string, std::vector<std::string>> lines;
  process::PosixProcessHost host{
      [this](const std::string& name, const std::string& line) { lines[name].push_back(line); }};
};

TEST_F(PosixProcessHostTest, reports_exit_code_and_output) {
  const process::ProcessExit exit = wait_for_exit(start("a", "echo out; echo err >&2; printf unfinished; exit 3"));
  EXPECT_EQ(exit.code, 3);
  EXPECT_EQ(exit.signal, 0);
  EXPECT_THAT(lines["a"], ElementsAre("out", "err", "unfinished"));
}

TEST_F(PosixProcessHostTest, reports_the_signal) {
  const process::ProcessExit exit = wait_for_exit(start("a", "kill -SEGV $$"));
  EXPECT_EQ(exit.signal, SIGSEGV);
  EXPECT_EQ(describe(exit), "killed by signal 11 (SIGSEGV)");
}

TEST_F(PosixProcessHostTest, measures_cpu_time_and_memory) {
  const process::ProcessExit exit = wait_for_exit(start("a", "i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done"));
  EXPECT_GT(exit.cpu_s, 0.0);
  EXPECT_GT(exit.peak_rss_mb, 0.1);
}

TEST_F(PosixProcessHostTest, names_an_executable_that_cannot_be_run) {
  try {
    host.start({"a", {"/nonexistent/rtd-slam"}});
    FAIL() << "started what does not exist";
  } catch (const process::ProcessError& error) {
    EXPECT_STREQ(error.what(), "cannot run /nonexistent/rtd-slam: No such file or directory");
  }
}

TEST_F(PosixProcessHostTest, child_leads_its_own_process_group_with_a_closed_stdin) {
  const process::ProcessId process = start("a", "cat; echo $$; exec sleep 10");
  wait_for_line("a");
  EXPECT_THAT(lines["a"], ElementsAre(std::to_string(process)));
  EXPECT_EQ(getpgid(static_cast<pid_t>(process)), static_cast<pid_t>(process));
}

TEST_F(PosixProcessHostTest, child_gets_the_niceness_asked_for) {
  wait_for_exit(host.start({"a", {"/bin/sh", "-c", "nice"}, 7}));
  wait_for_exit(start("b", "nice"));
  EXPECT_EQ(std::stoi(lines["a"].at(0)), std::min(19, std::stoi(lines["b"].at(0)) + 7));
}

TEST_F(PosixProcessHostTest, child_inherits_no_descriptor) {
  const int leaked = dup(STDERR_FILENO);  // as a DDS library opens its sockets: without close-on-exec
  wait_for_exit(start("a", "ls /proc/self/fd | wc -l"));
  close(leaked);
  EXPECT_THAT(lines["a"], ElementsAre("4")) << "stdin, stdout, stderr and the folder that ls lists";
}

TEST_F(PosixProcessHostTest, counts_the_signs_of_life_of_each_child) {
  setenv("WATCHDOG_PID", "1", 1);  // as systemd sets it for the launcher itself
  process::PosixProcessHost watching([](const std::string&, const std::string&) {}, milliseconds(2000));
  const std::string script =
      "import os, socket, time\n"
      "assert os.environ['WATCHDOG_USEC'] == '2000000' and 'WATCHDOG_PID' not in os.environ\n"
      "s = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)\n"
      "s.connect(os.environ['NOTIFY_SOCKET'].replace('@', chr(0)))\n"
      "s.send(b'READY=1'); s.send(b'WATCHDOG=1'); time.sleep(2); s.send(b'STOPPING=1'); time.sleep(60)\n";
  const process::ProcessId process = watching.start({"a", {"/usr/bin/env", "python3", "-c", script}});
  const process::ProcessId silent = watching.start({"b", {"/bin/sleep", "60"}});
  unsetenv("WATCHDOG_PID");
  const auto wait_for_signs = [&](std::uint64_t count) {
    const milliseconds give_up = now() + milliseconds(10'000);
    while (watching.signs_of_life(process) != count && now() < give_up) watching.wait(milliseconds(20));
    EXPECT_EQ(watching.signs_of_life(process), count);
  };
  EXPECT_EQ(watching.signs_of_life(process), 0U);
  wait_for_signs(2);
  wait_for_signs(0);  // about to end
  EXPECT_EQ(watching.signs_of_life(silent), 0U);
}

TEST_F(PosixProcessHostTest, knows_who_waits_for_a_processor) {
  const std::string spin = "exec taskset -c 0 sh -c 'while :; do :; done'";
  const process::ProcessId one = start("a", spin), other = start("b", spin), idle = start("c", "exec sleep 60");
  const milliseconds give_up = now() + milliseconds(20'000);
  while (host.waited_for_processor(one) + host.waited_for_processor(other) < milliseconds(300) && now() < give_up)
    host.wait(milliseconds(20));
  if (host.waited_for_processor(one) == milliseconds(0)) GTEST_SKIP() << "this kernel keeps no schedstat";
  EXPECT_LT(now(), give_up);
  EXPECT_LT(host.waited_for_processor(idle), host.waited_for_processor(one) + host.waited_for_processor(other));
  EXPECT_EQ(host.waited_for_processor(999'999'999), milliseconds(0));
}

TEST_F(PosixProcessHostTest, nothing_outlives_the_launcher) {
  int reported[2];
  ASSERT_EQ(pipe(reported), 0);
  const pid_t launcher = fork();
  if (launcher == 0) {
    process::PosixProcessHost inner([](const std::string&, const std::string&) {});
    const process::ProcessId process = inner.start({"a", {"/bin/sleep", "60"}});
    [[maybe_unused]] const auto written = write(reported[1], &process, sizeof(process));
    raise(SIGKILL);
  }
  process::ProcessId orphan = 0;
  ASSERT_EQ(read(reported[0], &orphan, sizeof(orphan)), static_cast<ssize_t>(sizeof(orphan)));
  waitpid(launcher, nullptr, 0);
  const std::string stat = "/proc/" + std::to_string(orphan) + "/exe";
  const milliseconds give_up = now() + milliseconds(5000);
  char target[64];
  while (readlink(stat.c_str(), target, sizeof(target)) > 0 && now() < give_up) usleep(10000);
  EXPECT_LT(readlink(stat.c_str(), target, sizeof(target)), 0) << "sleep still runs";
}

TEST_F(PosixProcessHostTest, ends_unresponsive_processes_in_time) {
  Supervisor supervisor(host, SupervisorOptions{}, nullptr);
  supervisor.start({"polite", {"/bin/sleep", "60"}, ServiceRole::kEssential}, now());
  supervisor.start({"unresponsive", {"/bin/sh", "-c", "trap '' TERM; echo up; while :; do sleep 60; done"}, {}}, now());
  wait_for_line("unresponsive");

  const milliseconds asked = now();
  supervisor.stop(asked, milliseconds(300), RunOutcome::kInterrupted);
  while (!supervisor.all_ended() && now() - asked < milliseconds(10000)) {
    host.wait(milliseconds(20));
    supervisor.update(now());
  }
  EXPECT_TRUE(supervisor.all_ended());
  EXPECT_GE((now() - asked).count(), 300);
  EXPECT_LT((now() - asked).count(), 2000);
}

}  // namespace
}  // namespace rtd::launcher
