// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <regex>
#include <sstream>

#include "tests/unit/evaluation/page_data.hpp"
#include "tests/unit/evaluation/report_fixture.hpp"

namespace rtd::eval {
namespace {

using namespace ::testing;
using rtd::test::read_text;
using rtd::test::TemporaryFolder;
using testing_support::page_data;
using testing_support::tum_text;
using testing_support::winding_path;

TEST_F(Report, json_has_the_promised_keys_with_the_right_values) {
  const auto report = json();
  EXPECT_EQ(report["frames_in"], 100);
  EXPECT_EQ(report["frames_tracked"], 94);
  EXPECT_EQ(report["frames_dropped"], 1);
  EXPECT_DOUBLE_EQ(report["coverage"], 0.94);
  EXPECT_DOUBLE_EQ(report["frames_per_s"], 8.0);
  EXPECT_EQ(report["cpu_s"]["slam"], 3.5);
  EXPECT_EQ(report["peak_rss_mb"]["filter"], 80);
  EXPECT_EQ(report["restarts"]["filter"], 1);
  EXPECT_EQ(report["drops"]["camera.late"], 1);
  EXPECT_EQ(report["source"], "synthetic:office");
  EXPECT_EQ(report["pace"], "lockstep");
  EXPECT_EQ(report["filter_mode"], "rtd");
  EXPECT_EQ(report["detector"], "v5lite-s");
  EXPECT_EQ(report["dds"], "fastdds");
  EXPECT_EQ(report["events"][0], "filter restarted");
  EXPECT_THAT(report["version"].get<std::string>(), testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
  EXPECT_EQ(report["features"]["removed_mean"], 30);
  EXPECT_EQ(report["map"]["keyframes"], 7);
}

TEST_F(Report, latency_is_from_published_to_pose) {
  const auto latency = json()["latency_ms"];
  EXPECT_EQ(latency["count"], 94);                        // frames with pose only
  EXPECT_NEAR(latency["p50"].get<double>(), 52.5, 1e-9);  // 1..100 ms without 41..45 and 61
  EXPECT_NEAR(latency["p99"].get<double>(), 99.07, 1e-9);
  EXPECT_NEAR(latency["max"].get<double>(), 100, 1e-9);
}

TEST_F(Report, stage_times_count_the_frames_in_which_the_stage_ran) {
  for (run_record::FrameRecord& frame : record_.frames) {
    if (frame.tracking.stage_ms[msg::kStageMapping] == 0) frame.tracking.stage_ms[msg::kStageMapping] = 0.0004F;
  }
  const auto stages = json()["stage_ms"];
  EXPECT_EQ(stages["slam.mapping"]["count"], 9);  // every tenth frame, frame 60 is missing
  EXPECT_EQ(stages["slam.mapping"]["p50"], 20);
  EXPECT_EQ(stages["filter.extract"]["count"], 99);
  EXPECT_EQ(stages["filter.extract"]["p99"], 11);
  EXPECT_TRUE(stages["filter.masks"]["p50"].is_null());
}

TEST_F(Report, lost_spans_join_lost_and_missing_frames) {
  const auto spans = json()["lost_spans"];
  ASSERT_EQ(spans.size(), 2U);
  EXPECT_EQ(spans[0]["first_seq"], 40);
  EXPECT_EQ(spans[0]["last_seq"], 44);
  EXPECT_EQ(spans[0]["frames"], 5);
  EXPECT_NEAR(spans[0]["start_s"].get<double>(), 4.0, 1e-9);
  EXPECT_EQ(spans[1]["first_seq"], 60);
  EXPECT_EQ(spans[1]["frames"], 1);
}

TEST_F(Report, a_missing_frame_next_to_lost_ones_makes_one_span) {
  record_.frames[60].tracking.state = msg::TrackingState::kLost;  // seq 61, right behind the missing 60
  const auto spans = json()["lost_spans"];
  ASSERT_EQ(spans.size(), 2U);
  EXPECT_EQ(spans[1]["first_seq"], 60);
  EXPECT_EQ(spans[1]["last_seq"], 61);
}

TEST_F(Report, final_and_published_trajectories_are_judged_apart) {
  const auto report = json();
  EXPECT_GT(report["ate_rmse_m"].get<double>(), 0.01);
  EXPECT_LT(report["ate_online_rmse_m"].get<double>(), 1e-9);
  EXPECT_GT(report["rpe_trans_rmse_m"].get<double>(), 0.001);
  EXPECT_LT(report["rpe_rot_rmse_deg"].get<double>(), 1e-3);
  EXPECT_EQ(report["evaluation"]["ate_m"]["count"], 100);
}

TEST_F(Report, integrity_is_that_of_the_published_poses) {
  for (std::size_t i = 50; i < record_.frames.size(); ++i)
    record_.frames[i].tracking.T_world_camera.translation_m[2] += 0.2;
  for (std::size_t i = 52; i < 60; ++i) record_.frames[i].tracking.state = msg::TrackingState::kDoubtful;
  const auto integrity = json()["integrity"];
  EXPECT_EQ(integrity["frames"], 99);
  EXPECT_EQ(integrity["dangerous"], 2);  // until the doubt, which lasts until the step is a second ago
  EXPECT_NEAR(integrity["delay_s_max"].get<double>(), 0.2, 1e-9);
  EXPECT_EQ(integrity["states"]["lost"], 5);
  EXPECT_TRUE(integrity["nees_ok"].is_null() || std::isnan(integrity["nees_ok"].get<double>()));
  EXPECT_TRUE(integrity["drift"].contains("quotient_m_per_rad"));
  EXPECT_THAT(page(), AllOf(HasSubstr("ok, but wrong"), HasSubstr("2 of 99 frames"), HasSubstr("needless doubt"),
                            HasSubstr("drift quotient"), Not(HasSubstr("nan"))));
}

TEST_F(Report, without_ground_truth_errors_are_null_and_said_to_be_unknown) {
  record_.groundtruth_path.clear();
  const auto report = json();
  for (const char* key :
       {"ate_rmse_m", "ate_online_rmse_m", "rpe_trans_rmse_m", "rpe_rot_rmse_deg", "evaluation", "integrity"}) {
    EXPECT_TRUE(report.contains(key) && report[key].is_null()) << key;
  }
  EXPECT_THAT(report["notes"], Contains("no ground truth"));
  EXPECT_EQ(report["frames_tracked"], 94);
  EXPECT_THAT(page(), AllOf(HasSubstr("no ground truth to compare with"), Not(HasSubstr("nan"))));
}

TEST_F(Report, unusable_files_become_notes) {
  record_.groundtruth_path = folder_.write("bad.txt", "1 2 3\n");
  record_.trajectory_path = folder_.file("gone.txt");
  const auto report = json();
  EXPECT_TRUE(report["ate_rmse_m"].is_null());
  EXPECT_THAT(report["notes"].dump(),
              AllOf(HasSubstr("bad.txt:1"), HasSubstr("gone.txt cannot be read: No such file")));
}

TEST_F(Report, ground_truth_of_another_time_is_a_note) {
  Trajectory other = winding_path(100, 0.1);
  for (auto& pose : other) pose.stamp_ns += 900'000'000'000'000;
  record_.groundtruth_path = folder_.write("other.txt", tum_text(other));
  EXPECT_TRUE(json()["ate_rmse_m"].is_null());
  EXPECT_THAT(json()["notes"].dump(), HasSubstr("no pose lies within 0.02 s"));
}

TEST_F(Report, frames_that_the_source_left_out_count_against_coverage) {
  record_.frames_left_out = 88;
  record_.left_out = {{"stamp_backwards", 88}};
  EXPECT_DOUBLE_EQ(json()["coverage"], 0.5);
  EXPECT_EQ(json()["frames_given"], 188);
  EXPECT_EQ(json()["left_out"]["stamp_backwards"], 88);
  const std::string text = summary_text(record_, summarize_run(record_), "out");
  EXPECT_THAT(text, AllOf(HasSubstr("188 given, 99 used, 94 with pose  (stamp_backwards 88, camera.late 1)"),
                          HasSubstr("50.0 %"), HasSubstr(" m over 100 poses  (as published: ")));
}

TEST_F(Report, two_poses_give_no_ate) {
  const Trajectory truth = winding_path(100, 0.1);
  record_.trajectory_path = folder_.write("two.txt", tum_text({truth[10], truth[11]}));
  EXPECT_TRUE(json()["ate_rmse_m"].is_null());
  EXPECT_THAT(json()["notes"].dump(), HasSubstr("trajectory: only 2 poses have a true one"));
}

TEST_F(Report, what_a_restarted_slam_lost_is_named) {
  const Trajectory truth = winding_path(100, 0.1);
  record_.trajectory_path = folder_.write("last.txt", tum_text(Trajectory(truth.begin() + 70, truth.end())));
  EXPECT_THAT(json()["notes"].dump(), Not(HasSubstr("restarted")));
  record_.processes["slam"].restarts = 1;
  EXPECT_THAT(json()["notes"].dump(),
              HasSubstr("slam was restarted: trajectory.txt has only the last 30 poses, from 7.0 "
                        "s on; the 64 before are in trajectory_online.txt"));
  EXPECT_DOUBLE_EQ(json()["coverage"], 0.94) << "they had poses";
}

TEST_F(Report, page_is_self_contained) {
  const std::string html = page();
  EXPECT_THAT(html, Not(HasSubstr("http:")));
  EXPECT_THAT(html, Not(HasSubstr("https:")));
  EXPECT_THAT(html, Not(HasSubstr("<link")));
  EXPECT_THAT(html, Not(HasSubstr("@import")));
  EXPECT_THAT(html, testing::EndsWith("</html>\n"));
  EXPECT_FALSE(std::regex_search(html, std::regex("(src|href)=\"")));
  EXPECT_THAT(page_data(html)["samples"][0]["jpeg"].get<std::string>(), testing::StartsWith("/9j/"));
}

TEST(Landmarks, are_thinned_and_those_of_other_files_left_out) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 1000\nend_header\n";
  for (int i = 0; i < 1000; ++i) text += "1 2 3\n";
  std::istringstream many(text), binary("ply\nformat binary_little_endian 1.0\nelement vertex 1\nend_header\n123"),
      none("");
  EXPECT_LE(read_landmarks(many, 100).size(), 100U);
  EXPECT_TRUE(read_landmarks(binary, 100).empty());
  EXPECT_TRUE(read_landmarks(none, 100).empty());
}

TEST_F(Report, text_from_outside_is_escaped) {
  record_.source = "tum:<b>&\"x\"";
  record_.events = {"<img src=x>"};
  record_.filter_mode = "</script><script>alert(1)</script>";
  EXPECT_THAT(page(), AllOf(Not(HasSubstr("<img")), Not(HasSubstr("<b>")), Not(HasSubstr("<script>alert"))));
  EXPECT_EQ(page_data(page())["report"]["events"][0], "<img src=x>");
}

TEST_F(Report, broken_sample_pictures_are_left_out) {
  record_.samples[0].jpeg = {1, 2, 3};
  const auto samples = page_data(page())["samples"];
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0]["seq"], 50);
}

TEST_F(Report, map_has_static_points_in_colour_where_there_is_no_room) {
  record_.samples[0].points = {{10, 12, {0, 0, 2}}, {64, 0, {0, 0, 2}}};  // the second beyond the image
  const RunSummary summary = summarize_run(record_);
  const auto layers = map_page_of(record_, summary).layers;
  EXPECT_EQ(layers[0].name, "Static points");
  ASSERT_EQ(layers[0].points_m.size(), 1U);
  EXPECT_EQ(layers[0].colors[0], (map_page::Color{90, 90, 90}));
  const Eigen::Vector3d expected_m = summary.estimate.at(3).T_world_body * Eigen::Vector3d(0, 0, 2);
  EXPECT_LT((layers[0].points_m[0].cast<double>() - expected_m).norm(), 1e-6);
  EXPECT_FALSE(layers[1].shown) << layers[1].name;
}

TEST_F(Report, files_are_written_and_parse) {
  const RunSummary summary = write_report(record_, folder_.path());
  EXPECT_EQ(summary.frames.with_pose, 94U);
  EXPECT_EQ(nlohmann::json::parse(read_text(folder_.file("report.json")))["frames_in"], 100);
  EXPECT_THAT(read_text(folder_.file("report.html")), testing::EndsWith("</html>\n"));
  EXPECT_THAT(read_text(folder_.file("map.html")), HasSubstr("Path of the camera"));
}

TEST_F(Report, folder_that_does_not_exist_is_named) {
  try {
    write_report(record_, folder_.path() / "nowhere");
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("nowhere/report.json"));
  }
}

TEST(EmptyRun, still_gives_a_valid_report) {
  TemporaryFolder folder;
  write_report(eval::Run{}, folder.path());
  const auto report = nlohmann::json::parse(read_text(folder.file("report.json")));
  EXPECT_EQ(report["frames_in"], 0);
  EXPECT_TRUE(report["coverage"].is_null());
  EXPECT_TRUE(report["latency_ms"]["p50"].is_null());
  EXPECT_TRUE(report["source"].is_null());
  EXPECT_THAT(read_text(folder.file("report.html")), Not(HasSubstr("nan")));
}

TEST(EmptyRun, invalid_utf8_in_texts_does_not_stop_the_report) {
  TemporaryFolder folder;
  eval::Run record;
  record.source = "tum:/\xff\xfe";
  write_report(record, folder.path());
  EXPECT_TRUE(nlohmann::json::parse(read_text(folder.file("report.json"))).contains("source"));
}

TEST_F(Report, long_runs_give_small_pages) {
  const run_record::FrameRecord last = record_.frames.back();
  for (int i = 1; i <= 50'000; ++i) {
    record_.frames.push_back(last);
    record_.frames.back().tracking.seq += static_cast<std::uint64_t>(i);
    record_.frames.back().tracking.stamp_ns += i * 100'000'000LL;
  }
  record_.samples.clear();
  EXPECT_LT(page().size(), 400'000U);
}

}  // namespace
}  // namespace rtd::eval
