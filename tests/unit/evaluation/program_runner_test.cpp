// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <csignal>

#include "services/evaluation/commands/experiment_command.hpp"
#include "tests/unit/evaluation/temporary_folder.hpp"

namespace rtd::eval {
namespace {

using testing::ElementsAre;
using testing_support::TemporaryFolder;

ProgramTask shell(const std::string& script) {
  return [script](int place) { return std::vector<std::string>{"/bin/sh", "-c", script, "sh", std::to_string(place)}; };
}

TEST(ProgramRunner, runs_all_and_passes_on_how_each_ended_and_what_it_printed) {
  service::InterruptSignals signals;
  std::vector<std::pair<int, std::string>> ended(3);
  EXPECT_TRUE(run_programs({shell("echo a; echo b"), shell("exit 3"), shell("echo c >&2")}, 2, signals,
                           [&](const ProgramResult& result) {
                             ended[result.task] = {result.exit.code, result.last_line};
                           }));
  EXPECT_THAT(ended, ElementsAre(std::pair{0, "b"}, std::pair{3, ""}, std::pair{0, "c"}));
}

TEST(ProgramRunner, gives_those_that_run_together_places_of_their_own) {
  const TemporaryFolder folder;
  const std::string script = "mkdir " + folder.file("") + "$1 && sleep 0.1 && rmdir " + folder.file("") + "$1";
  service::InterruptSignals signals;
  std::vector<int> codes(5, -1);
  run_programs(std::vector<ProgramTask>(5, shell(script)), 2, signals,
               [&](const ProgramResult& result) { codes[result.task] = result.exit.code; });
  EXPECT_THAT(codes, testing::Each(0)) << "a place has one program at a time";
}

TEST(ProgramRunner, a_signal_ends_those_that_run_without_a_call) {
  service::InterruptSignals signals;
  int calls = 0;
  const bool finished = run_programs({shell("kill -INT " + std::to_string(getpid())), shell("sleep 60")}, 2, signals,
                                     [&](const ProgramResult&) { ++calls; });
  EXPECT_FALSE(finished);
  EXPECT_LE(calls, 1);
}

}  // namespace
}  // namespace rtd::eval
