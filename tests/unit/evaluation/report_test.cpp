// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "services/evaluation/core/report/report.hpp"
#include "tests/support/evaluation_page/rendered.hpp"
#include "tests/unit/evaluation/fabricated_run.hpp"
#include "tests/unit/evaluation/page_data.hpp"
#include "tests/unit/evaluation/temporary_folder.hpp"

namespace rtd::eval {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing_support::fabricated_run;
using testing_support::fabricated_sample;
using testing_support::moved;
using testing_support::page_data;
using testing_support::read_text;
using testing_support::some_transform;
using testing_support::TemporaryFolder;
using testing_support::tum_text;
using testing_support::winding_path;

/// The fabricated run with files: ground truth, and a final trajectory that is too large by 10 %.
class Report : public testing::Test {
 protected:
  Report() : record_(fabricated_run()) {
    const Trajectory truth = winding_path(100, 0.1);
    record_.groundtruth_path = folder_.write("groundtruth.txt", tum_text(truth));
    record_.trajectory_path = folder_.write("trajectory.txt", tum_text(moved(truth, some_transform(), 1.1)));
    record_.samples = {fabricated_sample(3), fabricated_sample(50)};
  }

  nlohmann::ordered_json json() const { return report_json(record_, summarize_run(record_)); }
  std::string page() const { return report_html(record_, summarize_run(record_)); }
  /// What the page shows.
  std::string shown() const { return shown(page()); }
  std::string shown(const std::string& html) const {
    return testing_support::rendered(html, folder_.file("page.html"));
  }

  TemporaryFolder folder_;
  eval::Run record_;
};

/// What the script of a page draws; node runs it.
class ShownReport : public Report {
 protected:
  void SetUp() override {
    if (!testing_support::has_node()) GTEST_SKIP() << "node is not installed; deploy/setup.sh --viewers installs it";
  }
};

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

TEST_F(ShownReport, events_come_first_when_the_run_went_badly) {
  const auto events_before_trajectory = [&] {
    const std::string html = shown();
    return html.find("<h2>Events") < html.find("<h2>Trajectory");
  };
  EXPECT_FALSE(events_before_trajectory());
  record_.frames_in = 200;
  EXPECT_TRUE(events_before_trajectory());
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

TEST_F(ShownReport, has_every_section) {
  const std::string html = shown();
  for (const char* text :
       {"ATE RMSE", "94.00 %", "100 given, 99 used, 94 with pose", "Trajectory against ground truth", "Error over time",
        "Static and dynamic points", "Latency", "Stage times", "slam.mapping", "Sample frames",
        "frame 50: 1 kept, 1 removed", "Processes", "peak memory", "camera.late: 1 frames",
        "frames 40 to 44 without pose", "filter restarted", "synthetic:office", "data:image/jpeg;base64,/9j/"}) {
    EXPECT_THAT(html, HasSubstr(text)) << text;
  }
}

TEST_F(ShownReport, links_to_the_other_pages_of_the_run) {
  record_.pages = {{"Report", "report.html"}, {"Map in 3D", "map.html"}, {"Both runs", "../demo.html"}};
  EXPECT_THAT(shown(), AllOf(HasSubstr("<a href=\"file:///a%20run/map.html\">Map in 3D</a>"),
                             HasSubstr("<a href=\"file:///demo.html\">Both runs</a>"), Not(HasSubstr("report.html"))));
}

TEST_F(ShownReport, draws_for_a_phone_what_fits_its_width) {
  record_.landmarks_m = {{0, 0, 0}, {1, 0.1, 4}, {2, 0, 8}};
  const std::string html = testing_support::rendered(page(), folder_.file("page.html"), 390);
  const std::regex size("viewBox=\"0 (-?\\d+) (\\d+) ");
  std::size_t drawings = 0, with_two_rows = 0;
  for (std::sregex_iterator found(html.begin(), html.end(), size), end; found != end; ++found, ++drawings) {
    EXPECT_LE(std::stoi((*found)[2]), 440);
    with_two_rows += (*found)[1] == "-16" ? 1 : 0;
  }
  EXPECT_GE(drawings, 6U);
  EXPECT_EQ(with_two_rows, 1U) << "the legend of the features";
}

TEST_F(ShownReport, is_drawn_again_when_the_phone_is_turned) {
  const std::string file = folder_.file("page.html"), upright = testing_support::rendered(page(), file, 390);
  EXPECT_NE(testing_support::rendered(page(), file, 844), upright);
  EXPECT_EQ(testing_support::rendered(page(), file, 844, 390), upright);
}

TEST_F(ShownReport, comparison_has_a_row_for_each_figure_on_a_phone) {
  const std::string runs = comparison_html({{"filter off", record_}, {"filter rtd", record_}});
  const std::string html = testing_support::rendered(runs, folder_.file("page.html"), 390);
  EXPECT_THAT(html, HasSubstr("<tr><th>run</th><th>filter off</th><th>filter rtd</th></tr>"));
  EXPECT_THAT(html, HasSubstr("<tr><td>frames with pose</td><td>94.00 %</td><td>94.00 %</td></tr>"));
}

TEST_F(ShownReport, lists_no_drops_that_did_not_happen) {
  record_.drops["filter.dropped"] = 0;
  EXPECT_THAT(shown(), AllOf(HasSubstr("camera.late: 1"), Not(HasSubstr("filter.dropped"))));
}

TEST_F(ShownReport, says_when_and_why_the_pose_was_doubtful) {
  EXPECT_THAT(shown(), Not(HasSubstr("Why the pose was doubtful")));
  for (std::size_t i = 10; i < 13; ++i) record_.frames[i].tracking.state = msg::TrackingState::kDoubtful;
  for (int i = 0; i < 5; ++i) record_.events.push_back(fmt::format("slam: doubtful: {} % agree", 40 - i));
  const std::string html = shown();
  const auto section = html.substr(html.find("Why the pose was doubtful"), 900);
  EXPECT_THAT(section, HasSubstr("<td>10 to 12</td>"));
  EXPECT_THAT(section, AllOf(HasSubstr("40 % agree"), HasSubstr("(3 more"), HasSubstr("36 % agree")));
  EXPECT_THAT(section, Not(HasSubstr("39 % agree")));
}

TEST_F(ShownReport, has_the_map_that_lies_beside_it) {
  EXPECT_THAT(shown(), Not(HasSubstr("Map from above")));
  std::istringstream map(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n1 2 3 .9\n4 5 6 .9\nx\n");
  record_.landmarks_m = read_landmarks(map, 100);
  EXPECT_EQ(record_.landmarks_m.size(), 2U);
  EXPECT_THAT(shown(), HasSubstr("Map from above"));
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

TEST_F(ShownReport, sees_the_map_along_the_axis_of_least_spread) {
  const auto of_map = [&](const std::vector<Eigen::Vector3d>& landmarks_m) {
    record_.landmarks_m = landmarks_m;
    record_.trajectory_path = folder_.write("short.txt", "0 0 0 0 0 0 0 1\n");
    const std::string html = shown();
    return html.substr(html.find("aria-label=\"Map from above"));
  };
  EXPECT_THAT(of_map({{0, 0, 0}, {1, 0.1, 4}, {2, 0, 8}}), HasSubstr("z [m]"));
  EXPECT_THAT(of_map({{0, 0, 0}, {1, 4, 0.1}, {2, 8, 0}}), HasSubstr("y [m]"));
}

TEST_F(ShownReport, draws_kept_and_removed_points_where_the_camera_saw_them) {
  const std::string html = shown();
  EXPECT_TRUE(std::regex_search(html, std::regex("M10 12h0\"[^>]*stroke=\"#35e07a\"")));
  EXPECT_TRUE(std::regex_search(html, std::regex("M30 32h0\"[^>]*stroke=\"#f5222d\"")));
  EXPECT_FALSE(std::regex_search(html, std::regex("M30 32h0\"[^>]*stroke=\"#35e07a\"")));
}

TEST_F(Report, text_from_outside_is_escaped) {
  record_.source = "tum:<b>&\"x\"";
  record_.events = {"<img src=x>"};
  record_.filter_mode = "</script><script>alert(1)</script>";
  EXPECT_THAT(page(), AllOf(Not(HasSubstr("<img")), Not(HasSubstr("<b>")), Not(HasSubstr("<script>alert"))));
  EXPECT_EQ(page_data(page())["report"]["events"][0], "<img src=x>");
}

TEST_F(ShownReport, has_text_from_outside_as_text) {
  record_.source = "tum:<b>&\"x\"";
  record_.events = {"<img src=x>", "</script><script>alert(1)</script>"};
  EXPECT_THAT(shown(), AllOf(HasSubstr("tum:&lt;b&gt;&amp;&quot;x&quot;"), Not(HasSubstr("<img")),
                             Not(HasSubstr("<script")), HasSubstr("&lt;script&gt;alert(1)")));
}

TEST_F(ShownReport, has_the_pixels_of_people_on_its_samples) {
  EXPECT_THAT(shown(), Not(HasSubstr("fill:#ffb000")));
  record_.samples[0].masks = {16, 12, std::vector<std::uint8_t>(16 * 12, 0)};
  for (const std::size_t column : {3U, 4U, 5U}) record_.samples[0].masks.labels[16 * 2 + column] = 1;
  EXPECT_THAT(shown(), testing::ContainsRegex("<rect x=\"12\" y=\"8\" width=\"12\" height=\"4\"[^>]*fill:#ffb000"));
}

TEST_F(Report, broken_sample_pictures_are_left_out) {
  record_.samples[0].jpeg = {1, 2, 3};
  const auto samples = page_data(page())["samples"];
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0]["seq"], 50);
}

TEST_F(ShownReport, is_not_spoilt_by_numbers_that_are_not_finite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  record_.frames[5].tracking.stage_ms[msg::kStagePose] = std::numeric_limits<float>::infinity();
  record_.frames[6].filter_stage_ms[msg::kStageExtract] = nan;
  record_.frames[7].tracking.T_world_camera.translation_m[0] = nan;
  record_.frames[8].tracking.T_world_camera.rotation_xyzw = {0, 0, 0, 0};
  record_.frames[9].tracking.finished_ns = 0;
  record_.frames[10].tracking.published_ns = 0;
  record_.processes["slam"].peak_rss_mb = nan;
  record_.duration_s = nan;
  record_.samples[0].features[0].u_raw_px = nan;
  const auto report = json();
  EXPECT_EQ(report["stage_ms"]["slam.pose"]["max"], 2);
  EXPECT_EQ(report["stage_ms"]["filter.extract"]["count"], 98);
  EXPECT_EQ(report["latency_ms"]["count"], 92);
  EXPECT_LT(report["ate_online_rmse_m"].get<double>(), 1e-9);
  EXPECT_TRUE(report["peak_rss_mb"]["slam"].is_null());
  EXPECT_TRUE(report["duration_s"].is_null());
  EXPECT_THAT(page(), AllOf(Not(HasSubstr("nan")), Not(HasSubstr("inf\""))));
  EXPECT_THAT(shown(), AllOf(Not(HasSubstr("NaN")), Not(HasSubstr("undefined")), Not(HasSubstr("Infinity")),
                             Not(HasSubstr("null"))));
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

TEST_F(ShownReport, of_an_empty_run_says_what_is_unknown) {
  record_ = eval::Run{};
  EXPECT_THAT(shown(), AllOf(HasSubstr("unknown"), HasSubstr("no poses to show"), Not(HasSubstr("NaN")),
                             Not(HasSubstr("undefined"))));
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

TEST_F(ShownReport, comparison_names_both_runs_their_errors_and_the_ratio) {
  eval::Run good = record_;
  good.trajectory_path = folder_.write("good.txt", tum_text(moved(winding_path(100, 0.1), some_transform(), 1.01)));
  record_.filter_mode = "off";
  const std::string page = comparison_html({{"filter off", record_}, {"filter rtd", good}}), html = shown(page);
  const std::string off = std::to_string(summarize_run(record_).final_trajectory->ate.error_m.rmse * 100).substr(0, 4);
  EXPECT_THAT(html,
              AllOf(HasSubstr("ATE RMSE, filter off"), HasSubstr("ATE RMSE, filter rtd"), HasSubstr(off + " cm"),
                    HasSubstr("10 times less than filter off"), HasSubstr("ground truth"), Not(HasSubstr("NaN"))));
  EXPECT_THAT(page, AllOf(Not(HasSubstr("http:")), Not(HasSubstr("https:")), Not(HasSubstr("<link"))));
}

TEST_F(ShownReport, comparison_distinguishes_a_worse_and_an_equal_run) {
  eval::Run worse = record_;
  worse.trajectory_path = folder_.write("worse.txt", tum_text(moved(winding_path(100, 0.1), some_transform(), 1.2)));
  EXPECT_THAT(shown(comparison_html({{"a", record_}, {"b", worse}})), HasSubstr("2 times more than a"));
  EXPECT_THAT(shown(comparison_html({{"a", record_}, {"b", record_}})), HasSubstr("as much as a"));
}

TEST_F(ShownReport, comparison_without_ground_truth_or_runs_is_still_a_page) {
  record_.groundtruth_path.clear();
  EXPECT_THAT(shown(comparison_html({{"a", record_}, {"b", eval::Run{}}})),
              AllOf(HasSubstr("unknown"), Not(HasSubstr("NaN")), Not(HasSubstr("undefined"))));
  EXPECT_THAT(shown(comparison_html({})), HasSubstr("no runs to compare"));
}

}  // namespace
}  // namespace rtd::eval
