// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <csignal>

#include "common/service/config.hpp"
#include "services/evaluation/commands/experiment_command.hpp"
#include "services/evaluation/core/experiment/experiment.hpp"
#include "tests/support/temporary_folder.hpp"

namespace rtd::eval {
namespace {

using rtd::test::TemporaryFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<std::string> kModes{"off", "semantic", "geometry", "epipolar", "rtd-paper", "rtd"};
const std::vector<Technique> kTechniques{{"filter.techniques.depth_check", "no check"},
                                         {"slam.techniques.adaptive_kernel", "Huber"}};

std::vector<std::string> names(const VariantPlan& plan) {
  std::vector<std::string> result;
  for (const Variant& variant : plan.variants) result.push_back(variant.name);
  return result;
}

TEST(Variants, runs_every_mode_then_the_baseline_without_each_technique) {
  const VariantPlan plan = plan_variants({}, kModes, kTechniques);
  EXPECT_THAT(names(plan), ElementsAre("off", "semantic", "geometry", "epipolar", "rtd-paper", "rtd",
                                       "without depth_check", "without adaptive_kernel"));
  EXPECT_THAT(plan.variants[7].settings, ElementsAre("slam.techniques.adaptive_kernel=false"));
  EXPECT_EQ(plan.variants[7].mode, "rtd");
  EXPECT_EQ(plan.variants[7].folder(), "without_adaptive_kernel");
}

TEST(Variants, keeps_to_what_was_asked_and_adds_the_baseline_that_it_needs) {
  EXPECT_THAT(names(plan_variants({{"off"}, {"depth_check"}, true}, kModes, kTechniques)),
              ElementsAre("off", "rtd", "without depth_check"));
  EXPECT_THAT(names(plan_variants({{"off", "rtd"}, {"none"}, true}, kModes, kTechniques)), ElementsAre("off", "rtd"));
  EXPECT_THAT(names(plan_variants({{"rtd"}, {"slam.techniques.adaptive_kernel"}, true}, kModes, kTechniques)),
              ElementsAre("rtd", "without adaptive_kernel"));
}

TEST(Variants, leaves_out_what_is_nothing_without_a_detector_and_says_so) {
  const VariantPlan plan = plan_variants({{}, {"none"}, false}, kModes, kTechniques);
  EXPECT_THAT(names(plan), ElementsAre("off", "geometry", "rtd"));
  EXPECT_THAT(plan.notes, ElementsAre(HasSubstr("semantic"), HasSubstr("epipolar"), HasSubstr("rtd-paper")));
  EXPECT_THROW(plan_variants({{"semantic"}, {"none"}, false}, kModes, {}), service::ConfigError) << "nothing is left";
}

TEST(Variants, names_the_nearest_word_for_an_unknown_one) {
  EXPECT_THAT(
      [] {
        plan_variants({{}, {"depth_chek"}, true}, kModes, kTechniques);
      },
      testing::ThrowsMessage<service::ConfigError>(AllOf(HasSubstr("depth_chek"), HasSubstr("'depth_check'"))));
  EXPECT_THAT(
      [] {
        plan_variants({{"geometri"}, {}, true}, kModes, kTechniques);
      },
      testing::ThrowsMessage<service::ConfigError>(HasSubstr("did you mean 'geometry'")));
  EXPECT_THAT(
      [] {
        plan_variants({{}, {"zzzzzzzzzz"}, true}, kModes, kTechniques);
      },
      testing::ThrowsMessage<service::ConfigError>(HasSubstr("adaptive_kernel")))
      << "none is near: all are listed";
}

TEST(Variants, reads_the_techniques_from_what_a_service_prints) {
  const std::string printed =
      "bus:\n  techniques:\n    nonsense: true\nfilter:\n  mode: rtd  # which\n  techniques:\n"
      "    depth_check: true  # off: no check\n    belief: true\n  orb:\n    levels: 8\n";
  const std::vector<Technique> found = read_techniques(printed, "filter");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].key, "filter.techniques.depth_check");
  EXPECT_EQ(found[0].name(), "depth_check");
  EXPECT_EQ(found[0].without, "no check");
  EXPECT_EQ(found[1].key, "filter.techniques.belief");
  EXPECT_TRUE(read_techniques(printed, "slam").empty());
}

TEST(Variants, gives_every_source_a_folder_of_its_own) {
  EXPECT_THAT(
      source_names({"tum:/data/walk_xyz/", "tum:/other/walk_xyz?masks=1", "synthetic:office?frames=3", "tum:/.."}),
      ElementsAre("walk_xyz", "walk_xyz_2", "office", "source"));
}

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
