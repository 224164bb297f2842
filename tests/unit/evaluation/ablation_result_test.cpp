// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/ablation/ablation.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

namespace rtd::eval {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class AblationResultTest : public testing::Test {
 protected:
  AblationResultTest() {
    fs::create_directories(folder_);
    ablation_.version = "1.2";
    ablation_.pace = "lockstep";
    ablation_.sources = {"tum:/data/walk"};
    ablation_.source_names = {"walk"};
    ablation_.plan.variants = {{"off", "off", {}, ""},
                               {"rtd", "rtd", {}, ""},
                               {"without belief", "rtd", {"filter.techniques.belief=false"}, "one frame alone"}};
    ablation_.complete = true;
  }
  ~AblationResultTest() override { fs::remove_all(folder_); }

  Measurement& add(const std::string& variant, double ate_m, const std::string& trajectory = "") {
    Measurement m;
    m.source = "walk";
    m.variant = variant;
    m.ate_m = ate_m;
    m.coverage = 1;
    m.duration_s = 10;
    if (!trajectory.empty()) {
      m.trajectory = (folder_ / std::to_string(ablation_.measurements.size())).string();
      std::ofstream(m.trajectory) << trajectory;
    }
    ablation_.measurements.push_back(m);
    return ablation_.measurements.back();
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("rtd_ablation_" + std::to_string(getpid()));
  Ablation ablation_;
};

TEST_F(AblationResultTest, takes_its_figures_from_the_report_of_a_run) {
  std::ofstream(folder_ / "report.json") << R"({"frames_in": 3, "ate_rmse_m": 0.004, "coverage": 1.0,
      "rpe_trans_rmse_m": null, "stage_ms": {"filter.total": {"p50": 12.5}},
      "removal": {"precision": 0.5, "recall": 0.25, "after_first_second": {"precision": 0.9, "recall": null}}})";
  const auto m = read_measurement(folder_);
  ASSERT_TRUE(m);
  EXPECT_EQ(m->ate_m, 0.004);
  EXPECT_TRUE(std::isnan(m->rpe_m));
  EXPECT_EQ(m->filter_ms, 12.5);
  EXPECT_EQ(m->precision, 0.9);
  EXPECT_EQ(m->recall, 0.25) << "the whole run where there is nothing after the first second";
}

TEST_F(AblationResultTest, takes_nothing_from_a_missing_or_broken_report) {
  EXPECT_FALSE(read_measurement(folder_));
  for (const char* text : {"", "{", "[]", "{\"a\": 1}", "null"}) {
    std::ofstream(folder_ / "report.json") << text;
    EXPECT_FALSE(read_measurement(folder_)) << text;
  }
}

TEST_F(AblationResultTest, shows_median_and_spread_and_the_ratio_to_the_baseline) {
  ablation_.pace = "realtime";
  ablation_.runs = 3;
  add("off", 0.4);
  for (const double ate_m : {0.005, 0.003, 0.004}) add("rtd", ate_m);
  add("without belief", 0.008);
  const auto rows = summarize(ablation_);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[1].ate_m.median, 0.004);
  EXPECT_NEAR(rows[0].ratio, 100, 1e-9);
  EXPECT_NEAR(rows[2].ratio, 2, 1e-9);
  EXPECT_EQ(ablation_cells(rows[1])[1], "0.0040 (0.0030..0.0050)");
  EXPECT_EQ(ablation_cells(rows[2])[1], "0.0080");
}

TEST_F(AblationResultTest, has_no_ratio_before_the_baseline_was_run) {
  add("off", 0.4);
  EXPECT_EQ(ablation_cells(summarize(ablation_)[0])[2], "-");
}

TEST_F(AblationResultTest, says_which_runs_failed_and_continues_with_the_others) {
  add("off", 0.4);
  add("rtd", 0.004);
  add("rtd", 0.1).failure = "slam died";
  add("without belief", 0.1).failure = "no frame got a pose";
  const auto rows = summarize(ablation_);
  EXPECT_EQ(rows[1].ate_m.max, 0.004) << "a failed run counts for nothing";
  EXPECT_EQ(ablation_cells(rows[2])[1], "failed");
  EXPECT_THAT(ablation_text(ablation_),
              testing::AllOf(HasSubstr("1 of 2 runs failed: slam died"), HasSubstr("no frame")));
}

TEST_F(AblationResultTest, warns_when_lockstep_runs_differ) {
  add("rtd", 0.004, "1 0 0 0");
  add("rtd", 0.004, "1 0 0 0");
  EXPECT_FALSE(summarize(ablation_)[0].unlike);
  add("rtd", 0.004, "1 0 0 1");
  EXPECT_TRUE(summarize(ablation_)[0].unlike);
  EXPECT_THAT(ablation_markdown(ablation_), HasSubstr("differ"));
  ablation_.pace = "realtime";
  EXPECT_FALSE(summarize(ablation_)[0].unlike) << "there they may";
}

TEST_F(AblationResultTest, estimates_what_remains_from_the_runs_so_far) {
  EXPECT_FALSE(remaining_s(ablation_));
  add("off", 0.4);
  EXPECT_EQ(remaining_s(ablation_), 20);
  ablation_.source_names = {"walk", "other"};
  EXPECT_EQ(remaining_s(ablation_), 50) << "an unknown source is taken for average";
}

TEST_F(AblationResultTest, writes_json_with_every_key_and_null_for_the_unknown) {
  add("off", 0.4);
  add("rtd", 0.004);
  const auto json = ablation_json(ablation_);
  const auto& row = json["sources"][0]["rows"][1];
  for (const char* key :
       {"variant", "mode", "settings", "runs", "failed", "ate_rmse_m", "ate_ratio", "rpe_trans_rmse_m",
        "rpe_rot_rmse_deg", "coverage", "precision", "recall", "filter_ms", "trajectories_differ"}) {
    EXPECT_TRUE(row.contains(key)) << key;
  }
  EXPECT_EQ(row["ate_rmse_m"]["median"], 0.004);
  EXPECT_TRUE(row["precision"]["median"].is_null());
  EXPECT_EQ(json["complete"], true);
}

TEST_F(AblationResultTest, draws_a_page_of_its_own_even_when_nothing_is_known) {
  EXPECT_THAT(ablation_html(ablation_), HasSubstr("</html>"));
  add("off", 0.4);
  add("rtd", 0.004);
  add("without belief", 0.003).failure = "<b>bad</b>";
  const std::string page = ablation_html(ablation_);
  EXPECT_THAT(page, testing::AllOf(HasSubstr("<svg"), HasSubstr("Error of each mode")));
  EXPECT_EQ(page.find("<b>bad"), std::string::npos) << "escaped";
}

}  // namespace
}  // namespace rtd::eval
