// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/experiment/experiment.hpp"

#include <gmock/gmock.h>

#include "common/service/config.hpp"
#include "services/evaluation/commands/experiment_plan.hpp"
#include "tests/support/evaluation_page/rendered.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/evaluation/page_data.hpp"

namespace rtd::eval {
namespace {

using namespace ::testing;
using rtd::test::TemporaryFolder;
using testing_support::page_data;

const std::string kSource = "tum:/data/walk";

/// An ablation on one source: off, rtd, and rtd without one technique.
Experiment ablation() {
  Experiment experiment;
  experiment.name = "ablation";
  experiment.settings = {{"version", "1.2"},
                         {"build", "abcd"},
                         {"dataset", ""},
                         {"model", ""},
                         {"pace", "lockstep"},
                         {"frames", 0},
                         {"set", nlohmann::json::array()}};
  experiment.subjects = {{"walk", kSource}};
  experiment.variants = {{"off", "off", {}, ""},
                         {"rtd", "rtd", {}, ""},
                         {"without belief", "rtd", {"filter.techniques.belief=false"}, "one frame alone"}};
  experiment.repeats = experiment.complete = true;
  return experiment;
}

ExperimentRun& add(Experiment& experiment, const std::string& variant, double ate_m,
                   const std::string& trajectory = "") {
  const int run = static_cast<int>(experiment.results.size()) + 1;
  experiment.results.push_back(
      {kSource, variant, run, 10, "", {{"ate_m", ate_m}, {"coverage", 1 - 0.1 * run}}, trajectory});
  return experiment.results.back();
}

/// Runs of one variant.
Experiment runs_of(const std::vector<double>& ate_m) {
  Experiment experiment = ablation();
  for (const double one_m : ate_m) add(experiment, "rtd", one_m);
  return experiment;
}

TEST(FeatureCount, varies_except_for_the_first_run) {
  EXPECT_EQ(feature_count_of(1), 1000);
  std::set<int> counts;
  for (int run = 2; run < 100; ++run) counts.insert(feature_count_of(run));
  EXPECT_EQ(counts.size(), 98U) << "no run is made twice";
  EXPECT_GE(*counts.begin(), 800);
  EXPECT_LE(*counts.rbegin(), 1200);
}

TEST(FiguresOfARun, are_taken_from_its_report) {
  const TemporaryFolder folder;
  folder.write("report.json", R"({"frames_in": 3, "ate_rmse_m": 0.004, "coverage": 1.0,
      "rpe_trans_rmse_m": null, "stage_ms": {"filter.total": {"p50": 12.5}}, "integrity": {"dangerous_share": 0.02},
      "removal": {"precision": 0.5, "recall": 0.25, "after_first_second": {"precision": 0.9, "recall": null}}})");
  const Figures figures = read_figures(folder.path()).value();
  EXPECT_EQ(figures.at("ate_m"), 0.004);
  EXPECT_FALSE(figures.contains("rpe_m"));
  EXPECT_EQ(figures.at("filter_ms"), 12.5);
  EXPECT_EQ(figures.at("dangerous_share"), 0.02);
  EXPECT_EQ(figures.at("precision"), 0.9);
  EXPECT_EQ(figures.at("recall"), 0.25) << "the whole run where there is nothing after the first second";
}

TEST(FiguresOfARun, have_the_shares_of_the_states_and_lost_is_all_without_a_pose) {
  const TemporaryFolder folder;
  folder.write("report.json", R"({"frames_in": 200, "frames_given": 200, "integrity": {"states":
      {"ok": 120, "doubtful": 20, "predicted": 10, "odometry": 30, "lost": 15, "initializing": 5}}})");
  const Figures figures = read_figures(folder.path()).value();
  EXPECT_DOUBLE_EQ(figures.at("share.ok"), 0.6);
  EXPECT_DOUBLE_EQ(figures.at("share.doubtful"), 0.1);
  EXPECT_DOUBLE_EQ(figures.at("share.predicted"), 0.05);
  EXPECT_DOUBLE_EQ(figures.at("share.odometry"), 0.15) << "a pose from frame to frame is a pose";
  EXPECT_DOUBLE_EQ(figures.at("share.lost"), 0.1);
}

TEST(FiguresOfARun, are_none_of_a_missing_or_broken_report) {
  const TemporaryFolder folder;
  EXPECT_FALSE(read_figures(folder.path()));
  for (const char* text : {"", "{", "[]", "{\"a\": 1}", "null"}) {
    folder.write("report.json", text);
    EXPECT_FALSE(read_figures(folder.path())) << text;
  }
}

TEST(ExperimentRows, have_median_best_and_worst_run_and_the_ratio_to_the_baseline) {
  Experiment experiment = ablation();
  experiment.repeats = false;
  add(experiment, "off", 0.4);
  for (const double ate_m : {0.005, 0.003, 0.004}) add(experiment, "rtd", ate_m);
  add(experiment, "without belief", 0.008);
  const ExperimentTable table = table_of(experiment, nullptr);
  ASSERT_EQ(table.rows.size(), 3U) << "in the order of the plan";
  EXPECT_EQ(table.rows[1].figure("ate_m").median, 0.004);
  EXPECT_NEAR(table.rows[0].figure("ratio").median, 100, 1e-9);
  EXPECT_NEAR(table.rows[2].figure("ratio").median, 2, 1e-9);
  EXPECT_EQ(table.cells[1][2], "0.0040 (0.0030..0.0050)");
  EXPECT_EQ(table.cells[2][2], "0.0080");
}

TEST(ExperimentRows, have_no_ratio_before_the_baseline_was_run) {
  Experiment experiment = ablation();
  add(experiment, "off", 0.4);
  EXPECT_EQ(table_of(experiment, nullptr).cells[0][3], "-");
}

TEST(ExperimentRows, say_which_runs_failed_and_continue_with_the_others) {
  Experiment experiment = ablation();
  add(experiment, "off", 0.4);
  add(experiment, "rtd", 0.004);
  add(experiment, "rtd", 0.1).failure = "slam died";
  add(experiment, "without belief", 0.1).failure = "no frame got a pose";
  const ExperimentTable table = table_of(experiment, nullptr);
  EXPECT_EQ(table.rows[1].figure("ate_m").max, 0.004) << "a failed run counts for nothing";
  EXPECT_EQ(table.cells[2][2], "failed");
  EXPECT_THAT(experiment_text(experiment, nullptr),
              AllOf(HasSubstr("1 of 2 runs failed: slam died"), HasSubstr("no frame")));
}

TEST(ExperimentRows, warn_when_lockstep_runs_differ) {
  Experiment experiment = ablation();
  add(experiment, "rtd", 0.004, "aa");
  add(experiment, "rtd", 0.004, "aa");
  EXPECT_FALSE(summarize(experiment)[0].differ);
  add(experiment, "rtd", 0.004, "bb");
  EXPECT_TRUE(summarize(experiment)[0].differ);
  EXPECT_THAT(experiment_markdown(experiment, nullptr), HasSubstr("differ"));
  experiment.repeats = false;
  EXPECT_FALSE(summarize(experiment)[0].differ) << "there they may";
}

TEST(ExperimentRows, have_the_mean_only_when_all_of_its_sequences_are_there) {
  Experiment experiment = ablation();
  experiment.settings["dataset"] = "bonn";
  experiment.subjects.clear();
  for (const char* sequence : mean_sequences(Dataset::kBonn)) {
    EXPECT_NE(summarize(experiment).empty() ? "" : summarize(experiment).back().subject, kMeanName);
    experiment.subjects.push_back({sequence, sequence});
    experiment.results.push_back({sequence, "rtd", 1, 1, "", {{"ate_m", 0.02}}});
  }
  const ExperimentRow mean = summarize(experiment).back();
  EXPECT_EQ(mean.subject, kMeanName);
  EXPECT_NEAR(mean.figure("ate_m").median, 0.02, 1e-12);
}

TEST(RemainingTime, is_estimated_from_the_runs_so_far) {
  Experiment experiment = ablation();
  EXPECT_FALSE(remaining_s(experiment));
  add(experiment, "off", 0.4);
  EXPECT_EQ(remaining_s(experiment), 20);
  experiment.jobs = 2;
  EXPECT_EQ(remaining_s(experiment), 10);
  experiment.jobs = 1;
  experiment.subjects.push_back({"other", "tum:/data/other"});
  EXPECT_EQ(remaining_s(experiment), 50) << "an unknown source is taken for average";
}

TEST(MissingRuns, are_those_that_no_earlier_call_made_and_the_first_of_all_come_first) {
  Experiment experiment = runs_of({0.004});
  ExperimentOptions options;
  options.runs = 2;
  options.out_dir = "out";
  const std::vector<PlannedRun> planned = missing_runs(options, experiment);
  ASSERT_EQ(planned.size(), 5U);
  EXPECT_EQ(planned[0].variant.name, "off");
  EXPECT_EQ(planned[1].folder, "out/walk/without_belief/1");
  EXPECT_EQ(planned[3].run, 2);
}

TEST(ExperimentPage, shows_integrity_figures_when_runs_have_them) {
  Experiment experiment = runs_of({0.015});
  EXPECT_THAT(experiment_text(experiment, nullptr), AllOf(Not(HasSubstr("dangerous")), Not(HasSubstr("needless"))));
  experiment.results[0].figures["dangerous_share"] = 0.0123;
  const auto part = page_data(experiment_html(experiment, nullptr))["parts"][0];
  EXPECT_THAT(part["head"], Contains("dangerous [%]"));
  EXPECT_THAT(part["cells"][0], Contains("1.23"));
}

TEST(ExperimentPage, names_what_failed_and_what_was_left_out) {
  Experiment experiment = runs_of({0.015});
  experiment.complete = false;
  experiment.jobs = 2;
  experiment.results[0].failure = "exit code 1: no weights";
  experiment.left_out.push_back({"/data/rgbd_dataset_freiburg1_xyz", "it has no groundtruth.txt"});
  EXPECT_THAT(experiment_text(experiment, nullptr),
              AllOf(HasSubstr("1 of 1 runs failed: exit code 1: no weights"), HasSubstr("no groundtruth.txt"),
                    HasSubstr("incomplete"), HasSubstr("2 runs at a time")));
}

TEST(ExperimentPage, has_everything_in_it_even_when_nothing_is_known) {
  Experiment experiment = ablation();
  EXPECT_THAT(experiment_html(experiment, nullptr), testing::EndsWith("</html>\n"));
  add(experiment, "off", 0.4);
  add(experiment, "without belief", 0.003).failure = "</script><b>bad</b>";
  const std::string page = experiment_html(experiment, nullptr);
  for (const char* outside : {"http:", "https:", "src=", "@import", "<link", "<b>bad"})
    EXPECT_THAT(page, Not(HasSubstr(outside)));
  const auto data = page_data(page);
  EXPECT_EQ(data["kind"], "experiment");
  EXPECT_EQ(data["rows"][1]["failure"], "</script><b>bad</b>");
  EXPECT_EQ(data["parts"][0]["source"], kSource);
}

TEST(ExperimentPage, draws_the_modes_what_each_technique_is_worth_and_the_table) {
  if (!testing_support::has_node()) GTEST_SKIP() << "node is not installed; deploy/setup.sh --viewers installs it";
  const TemporaryFolder folder;
  const auto shown = [&](const Experiment& experiment) {
    return testing_support::rendered(experiment_html(experiment, nullptr), folder.file("page.html"));
  };
  Experiment experiment = ablation();
  EXPECT_THAT(shown(experiment), HasSubstr("RTD-SLAM ablation")) << "nothing is known yet";
  add(experiment, "off", 0.4);
  add(experiment, "rtd", 0.004);
  add(experiment, "without belief", 0.008);
  add(experiment, "without belief", 0.1).failure = "<b>bad</b>";
  EXPECT_THAT(shown(experiment), AllOf(HasSubstr("<svg"), HasSubstr("Error of each mode"), HasSubstr("40.00 cm"),
                                       HasSubstr("x 2.00"), HasSubstr("without belief: one frame alone"),
                                       HasSubstr("&lt;b&gt;bad"), HasSubstr("<td>0.4000</td>"), Not(HasSubstr("NaN"))));
}

TEST(ExperimentComparison, calls_a_change_better_or_worse_only_beyond_the_spread_of_three_runs) {
  const auto verdict = [](const std::vector<double>& before, const std::vector<double>& now) {
    return change_of(summarize(runs_of(now)).front(), summarize(runs_of(before))).value().verdict;
  };
  EXPECT_EQ(verdict({0.02, 0.021, 0.022}, {0.01, 0.011, 0.012}), "better");
  EXPECT_EQ(verdict({0.01, 0.011, 0.012}, {0.02, 0.021, 0.022}), "worse");
  EXPECT_EQ(verdict({0.01, 0.015, 0.03}, {0.02, 0.021, 0.022}), "");
  EXPECT_EQ(verdict({0.01, 0.01}, {0.02, 0.02}), "") << "too few runs";
  EXPECT_NEAR(change_of(summarize(runs_of({0.011})).front(), summarize(runs_of({0.01})))->percent(), 10, 1e-9);
  EXPECT_FALSE(change_of(summarize(runs_of({0.01})).front(), {}).has_value());
}

TEST(ExperimentComparison, is_two_columns_of_the_table) {
  const Experiment before = runs_of({0.02, 0.021, 0.022});
  EXPECT_THAT(experiment_text(runs_of({0.01, 0.0105, 0.011}), &before),
              AllOf(HasSubstr("ATE before [m]"), HasSubstr("0.0210"), HasSubstr("-50 % better")));
}

TEST(ExperimentFile, has_every_key_and_null_for_the_unknown) {
  const auto json = experiment_json(runs_of({0.004, 0.005}));
  for (const char* key : {"format", "name", "settings", "runs", "jobs", "complete", "baseline", "notes", "subjects",
                          "variants", "left_out", "rows", "results"})
    EXPECT_TRUE(json.contains(key)) << key;
  for (const char* key : {"subject", "variant", "runs", "failed", "failure", "trajectories_differ", "figures"})
    EXPECT_TRUE(json["rows"][0].contains(key)) << key;
  EXPECT_EQ(json["rows"][0]["figures"]["ate_m"]["max"], 0.005);
  EXPECT_EQ(json["complete"], true);
}

TEST(ExperimentFile, is_read_as_it_was_written) {
  const TemporaryFolder folder;
  Experiment before = runs_of({0.015, 0.012});
  before.results[1].failure = "killed";
  before.settings["set"] = {"slam.mapper.ba_iterations=0"};
  const Experiment after = read_experiment(folder.write("ablation.json", experiment_json(before).dump()));
  EXPECT_EQ(after.settings, before.settings);
  ASSERT_EQ(after.results.size(), 2U);
  EXPECT_EQ(after.results[0].figures, before.results[0].figures);
  EXPECT_EQ(after.results[1].failure, "killed");
  EXPECT_EQ(summarize(after).size(), 1U);
  EXPECT_NE(find_run(after, kSource, "rtd", 1), nullptr);
  EXPECT_EQ(find_run(after, kSource, "rtd", 2), nullptr) << "it failed";
}

TEST(ExperimentFile, is_refused_when_it_is_something_else) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& content, const std::string& cause) {
    const std::string file = folder.write("other.json", content);
    EXPECT_THAT([&] { read_experiment(file); },
                testing::ThrowsMessage<service::ConfigError>(AllOf(HasSubstr("other.json"), HasSubstr(cause))));
  };
  refused("{\"format\": 1}", "is not a file that");
  refused("[", "is not a file that");
  refused("{\"format\": 2}", "is damaged");
  EXPECT_THROW(read_experiment(folder.file("none.json")), service::ConfigError);
}

}  // namespace
}  // namespace rtd::eval
