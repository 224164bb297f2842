// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <csignal>

#include "services/evaluation/commands/benchmark_runner.hpp"
#include "tests/unit/evaluation/temporary_folder.hpp"

namespace rtd::eval {
namespace {

using testing::ElementsAre;
using testing_support::TemporaryFolder;

ProgramTask shell(const std::string& script, const std::string& first_of = "") {
  return {{"/bin/sh", "-c", script}, first_of};
}

TEST(ProgramRunner, runs_all_and_passes_on_how_each_ended_and_what_it_printed) {
  service::InterruptSignals signals;
  std::vector<std::pair<int, std::string>> ended(3);
  EXPECT_TRUE(run_programs({shell("echo a; echo b"), shell("exit 3"), shell("echo c >&2")}, 2, signals,
                           [&](const ProgramResult& result) {
                             ended[result.task] = {result.exit.code, result.lines.empty() ? "" : result.lines.back()};
                           }));
  EXPECT_THAT(ended, ElementsAre(std::pair{0, "b"}, std::pair{3, ""}, std::pair{0, "c"}));
}

TEST(ProgramRunner, tasks_of_one_word_wait_until_one_has_ended_well) {
  const TemporaryFolder folder;
  const std::string file = folder.file("made");
  service::InterruptSignals signals;
  std::vector<std::size_t> order;
  std::vector<int> codes(4);
  run_programs({shell("exit 1", "boxes"), shell("sleep 0.2; touch " + file, "boxes"), shell("test -e " + file, "boxes"),
                shell("true")},
               4, signals, [&](const ProgramResult& result) {
                 order.push_back(result.task);
                 codes[result.task] = result.exit.code;
               });
  EXPECT_THAT(codes, ElementsAre(1, 0, 0, 0)) << "the third needs what the second makes";
  EXPECT_EQ(order.back(), 2U);
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
