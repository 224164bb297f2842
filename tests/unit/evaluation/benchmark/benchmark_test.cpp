// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/benchmark/benchmark.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "common/service/config.hpp"
#include "services/evaluation/core/benchmark/published.hpp"
#include "tests/unit/evaluation/temporary_folder.hpp"

namespace rtd::eval {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

BenchmarkRun run(const std::string& sequence, const std::string& mode, int number, double ate_m) {
  return {sequence, "/data/" + sequence, mode, number, 12, "", {{"ate_m", ate_m}, {"coverage", 1 - 0.1 * number}}};
}

Benchmark tum(const std::vector<double>& ate_m) {
  Benchmark benchmark;
  benchmark.settings = {"1.0", "abcd", "tum", "off", 0, {}};
  benchmark.complete = true;
  for (int i = 0; i < static_cast<int>(ate_m.size()); ++i)
    benchmark.runs.push_back(run("fr3_walking_xyz", "rtd", i, ate_m[static_cast<std::size_t>(i)]));
  return benchmark;
}

TEST(Perturbation, varies_first_frame_and_feature_count_except_for_the_first_run) {
  EXPECT_EQ(perturbation_of(0).first_frame, 0);
  EXPECT_EQ(perturbation_of(0).feature_count, 1000);
  EXPECT_EQ(perturbation_of(1).first_frame, 1);
  EXPECT_EQ(perturbation_of(1).feature_count, 1150);
  EXPECT_EQ(perturbation_of(12).first_frame, 2);
  for (int i = 1; i < 30; ++i) {
    EXPECT_GE(perturbation_of(i).feature_count, 800);
    EXPECT_LE(perturbation_of(i).feature_count, 1200);
  }
}

TEST(FiguresOfARun, count_a_pose_from_frame_to_frame_as_a_pose) {
  const Figures figures = figures_of(
      nlohmann::json::parse(R"({"frames": 100, "states": {"ok": 70, "odometry": 20, "recently lost": 10}})"));
  EXPECT_DOUBLE_EQ(figures.at("share.odometry"), 0.2);
  EXPECT_DOUBLE_EQ(figures.at("share.lost"), 0.1);
}

TEST(FiguresOfARun, are_its_numbers_with_shares_of_the_states_and_the_time_of_a_frame) {
  const Figures figures = figures_of(nlohmann::json::parse(
      R"({"frames": 200, "ate_m": 0.01, "recall": null, "filter_ms": 12, "slam_ms": 5,
          "states": {"ok": 150, "doubtful": 20, "predicted": 10, "lost": 15, "initializing": 5},
          "integrity": {"dangerous_share": 0.02}})"));
  EXPECT_DOUBLE_EQ(figures.at("ate_m"), 0.01);
  EXPECT_FALSE(figures.contains("recall"));
  EXPECT_DOUBLE_EQ(figures.at("ms"), 17);
  EXPECT_DOUBLE_EQ(figures.at("share.ok"), 0.75);
  EXPECT_DOUBLE_EQ(figures.at("share.doubtful"), 0.1);
  EXPECT_DOUBLE_EQ(figures.at("share.predicted"), 0.05);
  EXPECT_DOUBLE_EQ(figures.at("share.lost"), 0.1) << "all without a pose";
  EXPECT_DOUBLE_EQ(figures.at("integrity.dangerous_share"), 0.02);
  EXPECT_TRUE(figures_of(nlohmann::json::parse(R"({"integrity.dangerous_share": 0.02})"))
                  .contains("integrity.dangerous_share"));
}

TEST(BenchmarkRows, have_the_median_and_the_best_and_worst_run) {
  Benchmark benchmark = tum({0.015, 0.012, 0.020});
  benchmark.runs.push_back(run("fr3_walking_xyz", "off", 0, 0.7));
  benchmark.runs.push_back(run("fr3_walking_xyz", "off", 1, 0.8));
  benchmark.runs.back().failure = "killed";
  const std::vector<BenchmarkRow> rows = summarize(benchmark);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].mode, "off") << "modes in the order of the filter's table";
  EXPECT_EQ(rows[0].failed, 1);
  EXPECT_DOUBLE_EQ(rows[0].figure("ate_m").max, 0.7) << "failed runs do not count";
  EXPECT_DOUBLE_EQ(rows[1].figure("ate_m").median, 0.015);
  EXPECT_DOUBLE_EQ(rows[1].figure("ate_m").min, 0.012);
  EXPECT_DOUBLE_EQ(rows[1].figure("ate_m").max, 0.020);
}

TEST(BenchmarkRows, have_the_mean_only_when_all_of_its_sequences_are_there) {
  Benchmark benchmark;
  benchmark.settings.dataset = "bonn";
  for (const char* sequence : mean_sequences(Dataset::kBonn)) {
    EXPECT_NE(summarize(benchmark).empty() ? "" : summarize(benchmark).back().sequence, kMeanName);
    benchmark.runs.push_back(run(sequence, "rtd", 0, 0.02));
  }
  const BenchmarkRow mean = summarize(benchmark).back();
  EXPECT_EQ(mean.sequence, kMeanName);
  EXPECT_NEAR(mean.figure("ate_m").median, 0.02, 1e-12);
}

TEST(BenchmarkPage, shows_published_figures_with_their_source_beside_ours) {
  const std::string page = benchmark_html(tum({0.015, 0.012, 0.020}), nullptr);
  EXPECT_THAT(page, AllOf(HasSubstr("0.0150 (0.0120–0.0200)"), HasSubstr("NGD-SLAM"), HasSubstr("arXiv 2405.07392"),
                          HasSubstr("DS-SLAM"), HasSubstr("Sim(3)"), HasSubstr("GPU"), HasSubstr("0.826")));
  EXPECT_THAT(page, Not(HasSubstr("dangerous"))) << "no run has integrity figures";
}

TEST(BenchmarkPage, shows_integrity_figures_when_runs_have_them) {
  Benchmark benchmark = tum({0.015});
  benchmark.runs[0].figures["integrity.dangerous_share"] = 0.0123;
  EXPECT_THAT(benchmark_html(benchmark, nullptr), AllOf(HasSubstr("dangerous, most %"), HasSubstr("1.23")));
  EXPECT_THAT(benchmark_text(benchmark, nullptr), Not(HasSubstr("needless")));
}

TEST(BenchmarkPage, names_what_failed_and_what_was_left_out) {
  Benchmark benchmark = tum({0.015});
  benchmark.complete = false;
  benchmark.jobs = 2;
  benchmark.runs[0].failure = "exit code 1: no weights";
  benchmark.left_out.push_back({"/data/rgbd_dataset_freiburg1_xyz", "it has no groundtruth.txt"});
  EXPECT_THAT(benchmark_text(benchmark, nullptr),
              AllOf(HasSubstr("1 of 1 runs failed: exit code 1: no weights"), HasSubstr("no groundtruth.txt"),
                    HasSubstr("incomplete"), HasSubstr("2 runs at a time")));
}

TEST(BenchmarkComparison, calls_a_change_better_or_worse_only_beyond_the_spread_of_three_runs) {
  const auto verdict = [](const std::vector<double>& before, const std::vector<double>& now) {
    return change_of(summarize(tum(now)).front(), summarize(tum(before))).value().verdict;
  };
  EXPECT_EQ(verdict({0.02, 0.021, 0.022}, {0.01, 0.011, 0.012}), "better");
  EXPECT_EQ(verdict({0.01, 0.011, 0.012}, {0.02, 0.021, 0.022}), "worse");
  EXPECT_EQ(verdict({0.01, 0.015, 0.03}, {0.02, 0.021, 0.022}), "");
  EXPECT_EQ(verdict({0.01, 0.01}, {0.02, 0.02}), "") << "too few runs";
  EXPECT_NEAR(change_of(summarize(tum({0.011})).front(), summarize(tum({0.01})))->percent(), 10, 1e-9);
  EXPECT_FALSE(change_of(summarize(tum({0.01})).front(), {}).has_value());
}

TEST(BenchmarkComparison, is_two_columns_of_the_table) {
  const Benchmark before = tum({0.02, 0.021, 0.022});
  EXPECT_THAT(benchmark_text(tum({0.01, 0.0105, 0.011}), &before),
              AllOf(HasSubstr("ATE before [m]"), HasSubstr("0.0210"), HasSubstr("-50 % better")));
}

TEST(BenchmarkFile, is_read_as_it_was_written) {
  const testing_support::TemporaryFolder folder;
  Benchmark before = tum({0.015, 0.012});
  before.runs[1].failure = "killed";
  before.settings.set = {"slam.mapper.ba_iterations=0"};
  const std::string file = folder.write("benchmark.json", benchmark_json(before).dump());
  const Benchmark after = read_benchmark(file);
  EXPECT_EQ(after.settings, before.settings);
  ASSERT_EQ(after.runs.size(), 2U);
  EXPECT_EQ(after.runs[0].figures, before.runs[0].figures);
  EXPECT_EQ(after.runs[1].failure, "killed");
  EXPECT_NE(find_run(after, "/data/fr3_walking_xyz", "rtd", 0), nullptr);
  EXPECT_EQ(find_run(after, "/data/fr3_walking_xyz", "rtd", 1), nullptr) << "it failed";
}

TEST(BenchmarkFile, is_refused_when_it_is_something_else) {
  const testing_support::TemporaryFolder folder;
  const auto refused = [&](const std::string& content, const std::string& cause) {
    const std::string file = folder.write("other.json", content);
    EXPECT_THAT([&] { read_benchmark(file); },
                testing::ThrowsMessage<service::ConfigError>(AllOf(HasSubstr("other.json"), HasSubstr(cause))));
  };
  refused("{\"format\": 2}", "is not a benchmark.json");
  refused("[", "is not a benchmark.json");
  refused("{\"format\": 1}", "is damaged");
  EXPECT_THROW(read_benchmark(folder.file("none.json")), service::ConfigError);
}

TEST(PublishedFigures, name_known_sequences_and_plausible_errors) {
  for (const Dataset dataset : {Dataset::kTum, Dataset::kBonn}) {
    for (const PublishedMethod& method : published_methods(dataset)) {
      EXPECT_GT(std::string(method.source).size(), 10U);
      for (const PublishedFigure& figure : method.figures) {
        EXPECT_GT(figure.ate_m, 0.003) << method.method;
        EXPECT_LT(figure.ate_m, 1) << "metres, not centimetres: " << method.method;
      }
    }
  }
  EXPECT_TRUE(published_methods(Dataset::kOpenloris).empty());
}

}  // namespace
}  // namespace rtd::eval
