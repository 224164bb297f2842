// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <limits>
#include <regex>
#include <sstream>

#include "tests/unit/evaluation/report_fixture.hpp"

namespace rtd::eval {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::moved;
using testing_support::some_transform;
using testing_support::tum_text;
using testing_support::winding_path;

TEST_F(ShownReport, events_come_first_when_the_run_went_badly) {
  const auto events_before_trajectory = [&] {
    const std::string html = shown();
    return html.find("<h2>Events") < html.find("<h2>Trajectory");
  };
  EXPECT_FALSE(events_before_trajectory());
  record_.frames_in = 200;
  EXPECT_TRUE(events_before_trajectory());
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

TEST_F(ShownReport, of_an_empty_run_says_what_is_unknown) {
  record_ = eval::Run{};
  EXPECT_THAT(shown(), AllOf(HasSubstr("unknown"), HasSubstr("no poses to show"), Not(HasSubstr("NaN")),
                             Not(HasSubstr("undefined"))));
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
