// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/io/atomic_file.hpp"
#include "common/run_record/run_record.hpp"
#include "services/evaluation/commands/report_command.hpp"
#include "services/evaluation/core/report/report.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/evaluation/fabricated_run.hpp"
#include "tests/unit/evaluation/page_data.hpp"

namespace rtd::eval {
namespace {

using rtd::test::read_text;
using rtd::test::TemporaryFolder;
using testing::HasSubstr;
using testing_support::fabricated_run;
using testing_support::fabricated_sample;
using testing_support::moved;
using testing_support::some_transform;
using testing_support::tum_text;
using testing_support::winding_path;

std::vector<std::uint8_t> bytes(const std::string& text) {
  return {text.begin(), text.end()};
}

TEST(Base64, matches_the_vectors_of_rfc_4648_both_ways) {
  const std::vector<std::pair<std::string, std::string>> vectors{
      {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, text] : vectors) {
    EXPECT_EQ(run_record::to_base64(bytes(plain)), text);
    EXPECT_EQ(run_record::from_base64(text), bytes(plain));
  }
  EXPECT_EQ(run_record::to_base64({0xFF, 0xFE, 0xFD}), "//79");
}

TEST(Base64, refuses_other_texts) {
  for (const char* text :
       {"Zg=", "Z", "Zg!=", "Z===", "====", "Zm9v\n", "Zg==Zg==", "Z=8=", "    Zm9v", "Zm9v    ", "Zm\n9"}) {
    EXPECT_THROW(run_record::from_base64(text), std::invalid_argument) << text;
  }
}

TEST(FrameUse, frames_that_were_left_out_count) {
  run_record::RunRecord run = fabricated_run();  // 100 in, 94 with pose, 1 without answer
  EXPECT_EQ(run_record::frame_use(run).text(), "100 given, 99 used, 94 with pose");
  run.frames_left_out = 88;
  EXPECT_EQ(run_record::frame_use(run).text(), "188 given, 99 used, 94 with pose");
  EXPECT_DOUBLE_EQ(run_record::frame_use(run).coverage(), 0.5);
  EXPECT_FALSE(run_record::frame_use(run).too_few());
  run.frames_left_out = 99;
  EXPECT_TRUE(run_record::frame_use(run).too_few());
}

TEST(FrameUse, frames_that_the_run_did_not_come_to_count) {
  run_record::RunRecord run = fabricated_run();
  run.frames_not_played = 100;
  EXPECT_EQ(run_record::frame_use(run).text(), "200 given, 99 used, 94 with pose");
  EXPECT_TRUE(run_record::frame_use(run).too_few());
}

TEST(FrameUse, frames_without_depth_in_range_are_not_used) {
  run_record::RunRecord run = fabricated_run();
  run.frames.clear();
  run.frames_dropped = 0;
  run.frames_out_of_range = 60;
  EXPECT_EQ(run_record::frame_use(run).used, 40U);
  EXPECT_TRUE(run_record::frame_use(run).too_few());
  EXPECT_FALSE(run_record::frame_use({}).too_few()) << "nothing given, nothing to use";
}

/// A run with every kind of data, written to run.json in a folder.
class RunJson : public testing::Test {
 protected:
  RunJson() : run_(fabricated_run()) {
    run_.version = "1.2.3";
    run_.clocks = {{"detector", -3.25, 0.5}};
    run_.samples = {fabricated_sample(3), fabricated_sample(4)};
    run_.samples[1].masks = {16, 12, std::vector<std::uint8_t>(16 * 12, 1)};
    run_.processes["filter"].deaths = 2;
    run_.processes["filter"].died = "died: exit code 1";
    run_.frames_left_out = 7;
    run_.frames_not_played = 11;
    run_.left_out = {{"stamp_backwards", 5}, {"stamp_doubled", 2}};
    run_.judged_frames = {{run_.frames[0].tracking.stamp_ns, {{1.5F, 2.25F, true}, {-0.1F, 479.0F, false}}}};
    run_.frames[2].tracking.T_world_camera.translation_m[1] = std::numeric_limits<double>::quiet_NaN();
    run_.frames[3].filter_stage_ms[0] = std::numeric_limits<float>::infinity();
  }
  run_record::RunRecord written_and_read() const {
    run_record::write_run_json(run_, folder_.file("run.json"));
    return run_record::read_run_json(folder_.file("run.json"));
  }
  std::string why_unreadable(const std::string& text) const {
    folder_.write("run.json", text);
    try {
      run_record::read_run_json(folder_.file("run.json"));
    } catch (const run_record::RunFileError& error) {
      return error.what();
    }
    return "it can be read";
  }

  TemporaryFolder folder_;
  eval::Run run_;
};

TEST_F(RunJson, keeps_every_bit_that_the_report_needs) {
  eval::Run read{written_and_read()};
  const RunSummary before = summarize_run(run_), after = summarize_run(read);
  EXPECT_EQ(report_json(read, after).dump(), report_json(run_, before).dump());
  EXPECT_EQ(report_html(read, after), report_html(run_, before));
  EXPECT_EQ(report_json(read, after)["deaths"][0], "filter died: exit code 1 (2 times)");
}

TEST_F(RunJson, keeps_the_features_and_whether_the_run_was_interrupted) {
  run_.interrupted = true;
  const run_record::RunRecord read = written_and_read();
  EXPECT_TRUE(read.interrupted);
  ASSERT_EQ(read.judged_frames.size(), 1U);
  EXPECT_EQ(read.judged_frames[0].stamp_ns, run_.judged_frames[0].stamp_ns);
  ASSERT_EQ(read.judged_frames[0].features.size(), 2U);
  EXPECT_EQ(read.judged_frames[0].features[1].u_raw_px, -0.1F);
  EXPECT_TRUE(read.judged_frames[0].features[0].removed);
  EXPECT_FALSE(read.judged_frames[0].features[1].removed);
}

TEST_F(RunJson, keeps_masks_of_people_and_refuses_those_of_another_size) {
  const run_record::RunRecord read = written_and_read();
  EXPECT_TRUE(read.samples.at(0).masks.empty());
  EXPECT_EQ(read.samples.at(1).masks.rows, 12);
  EXPECT_EQ(read.samples.at(1).masks.labels, run_.samples[1].masks.labels);
  nlohmann::json json = nlohmann::json::parse(read_text(folder_.file("run.json")));
  json["samples"][1]["masks"]["rows"] = 13;
  EXPECT_THAT(why_unreadable(json.dump()), HasSubstr("masks of another size"));
}

TEST_F(RunJson, keeps_points_and_reads_files_without_them) {
  run_.samples[1].points = {{1, 2, {3, 4, 5}}};
  const run_record::RunRecord read = written_and_read();
  EXPECT_TRUE(read.samples.at(0).points.empty());
  ASSERT_EQ(read.samples.at(1).points.size(), 1U);
  EXPECT_EQ(read.samples.at(1).points[0].p_camera_m[2], 5);
  nlohmann::json json = nlohmann::json::parse(read_text(folder_.file("run.json")));
  json["samples"][1].erase("points");
  EXPECT_THAT(why_unreadable(json.dump()), "it can be read");
}

TEST_F(RunJson, takes_what_is_not_finite_for_unknown) {
  const run_record::RunRecord read = written_and_read();
  EXPECT_TRUE(std::isnan(read.frames[2].tracking.T_world_camera.translation_m[1]));
  EXPECT_TRUE(std::isnan(read.frames[3].filter_stage_ms[0]));
}

TEST_F(RunJson, that_cannot_be_used_is_named_with_the_cause) {
  EXPECT_THAT(why_unreadable(""), HasSubstr("run.json: is not the record of a run"));
  EXPECT_THAT(why_unreadable("{}"), HasSubstr("run.json: is not the record of a run"));
  EXPECT_THAT(why_unreadable(R"({"format": 2})"), HasSubstr("has format 2, this rtd-eval reads format 1"));
  run_record::write_run_json(run_, folder_.file("run.json"));
  nlohmann::json json = nlohmann::json::parse(read_text(folder_.file("run.json")));
  json["frames"]["stamp_ns"].erase(0);
  EXPECT_THAT(why_unreadable(json.dump()), HasSubstr("run.json: is not the record of a run"));
  json["samples"][0]["jpeg"] = "?";
  EXPECT_THAT(why_unreadable(json.dump()), HasSubstr("run.json: "));
  EXPECT_THROW(run_record::write_run_json(run_, folder_.file("nowhere/run.json")), run_record::RunFileError);
}

/// `rtd-eval report` on a folder as `rtd run` leaves it.
class ReportCommand : public RunJson {
 protected:
  int report(std::function<bool()> go_on = [] { return true; }) {
    run_record::write_run_json(run_, folder_.file("run.json"));
    out_.str("");
    err_.str("");
    return run_report({folder_.path().string()}, go_on, out_, err_);
  }
  nlohmann::json json() const { return nlohmann::json::parse(read_text(folder_.file("report.json"))); }

  std::ostringstream out_, err_;
};

TEST_F(ReportCommand, writes_both_reports_and_prints_the_table) {
  folder_.write("groundtruth.txt", tum_text(winding_path(100, 0.1)));
  folder_.write("trajectory.txt", tum_text(moved(winding_path(100, 0.1), some_transform(), 1.1)));
  EXPECT_EQ(report(), 0) << err_.str();
  EXPECT_GT(json()["ate_rmse_m"], 0.01);
  EXPECT_EQ(json()["version"], "1.2.3");
  EXPECT_THAT(read_text(folder_.file("report.html")), testing::EndsWith("</html>\n"));
  EXPECT_THAT(out_.str(),
              testing::AllOf(HasSubstr("  frames      118 given, 99 used, 94 with pose  (not_played 11, stamp"),
                             HasSubstr("ATE rmse"), HasSubstr("/report.html")));
}

TEST_F(ReportCommand, judges_the_published_poses_when_slam_left_no_trajectory) {
  folder_.write("trajectory_online.txt", tum_text(winding_path(100, 0.1)));
  EXPECT_EQ(report(), 0);
  EXPECT_THAT(json()["events"].dump(), HasSubstr("slam left no trajectory.txt"));
  EXPECT_THAT(json()["notes"].dump(), HasSubstr("no ground truth"));
}

TEST_F(ReportCommand, judges_few_frames_of_an_interrupted_run_and_none_when_the_user_stops_that) {
  run_.source = "synthetic:office?frames=60&width=160&height=120";
  run_.judged_frames.clear();
  for (int i = 0; i < 60; ++i) run_.judged_frames.push_back({1'000'000'000'000 + i, {{1, 1, true}}});
  run_.interrupted = true;
  EXPECT_EQ(report(), 0);
  EXPECT_EQ(json()["removal"]["frames"], 1) << "one stamp is that of a frame of the scene";
  EXPECT_THAT(json()["events"].dump(), HasSubstr("interrupted: removal judged on 1 of 60 frames"));
  EXPECT_EQ(report([] { return false; }), 0);
  EXPECT_TRUE(json()["removal"].is_null());
}

TEST_F(ReportCommand, without_a_run_is_exit_code_2_and_without_room_1) {
  EXPECT_EQ(run_report(
                {folder_.file("nowhere")}, [] { return true; }, out_, err_),
            2);
  EXPECT_THAT(err_.str(), HasSubstr("nowhere/run.json cannot be read"));
  std::filesystem::create_directory(folder_.file("report.json"));
  EXPECT_EQ(report(), 1);
  EXPECT_THAT(err_.str(), HasSubstr("report.json: this is a folder"));
}

TEST_F(ReportCommand, compares_runs_on_one_page) {
  EXPECT_EQ(report(), 0);
  const std::string folder = folder_.path().string(), page = folder_.file("both.html");
  EXPECT_EQ(run_compare({{folder, folder}, {"first"}, page}, out_, err_), 0) << err_.str();
  EXPECT_THAT(out_.str(), testing::AllOf(HasSubstr("  first "), HasSubstr("  " + folder), HasSubstr("79.7 %")));
  EXPECT_THAT(read_text(page), testing::AllOf(HasSubstr("\"label\":\"first\""), HasSubstr("\"kind\":\"comparison\"")));
}

TEST_F(ReportCommand, pages_link_to_those_that_exist) {
  using Pages = std::vector<std::pair<std::string, std::string>>;
  const std::string folder = folder_.file("out/run"), page = folder_.file("out/demo.html");
  std::filesystem::create_directories(folder);
  run_record::write_run_json(run_, folder + "/run.json");
  const Pages own = {{"Report", "report.html"}, {"Map in 3D", "map.html"}};
  EXPECT_EQ(load_run(folder).pages, own);
  io::write_file(page, "");
  EXPECT_EQ(load_run(folder).pages.back(), Pages::value_type("Both runs", "../demo.html"));
  io::write_file(folder + "/map.html", "");
  EXPECT_EQ(run_compare({{folder}, {}, page}, out_, err_), 0) << err_.str();
  const auto linked = testing_support::page_data(read_text(page))["runs"][0]["pages"].get<Pages>();
  EXPECT_EQ(linked, (Pages{{"Map in 3D", "run/map.html"}, {"Both runs", "demo.html"}}));
}

}  // namespace
}  // namespace rtd::eval
