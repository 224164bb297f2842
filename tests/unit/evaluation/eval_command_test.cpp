// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/commands/eval_command.hpp"

#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "services/evaluation/core/report/run_summary.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/evaluation/fabricated_run.hpp"

namespace rtd::eval {
namespace {

using namespace ::testing;
using rtd::test::read_text;
using rtd::test::TemporaryFolder;
using testing_support::moved;
using testing_support::some_transform;
using testing_support::tum_text;
using testing_support::winding_path;

struct Outcome {
  int code = -1;
  std::string out, err;
};

class EvalCommand : public testing::Test {
 protected:
  EvalCommand() {
    const Trajectory truth = winding_path(60, 0.1);
    Trajectory estimate = moved(truth, some_transform(), 0.5);
    estimate.erase(estimate.begin() + 20, estimate.begin() + 30);
    truth_ = folder_.write("groundtruth.txt", tum_text(truth));
    estimate_ = folder_.write("trajectory.txt", tum_text(estimate));
  }

  Outcome run(const std::vector<std::string>& arguments) const {
    CLI::App app;
    EvalOptions options;
    add_eval_command(app, options);
    std::vector<std::string> reversed{arguments.rbegin(), arguments.rend()};
    reversed.push_back("trajectory");
    app.parse(reversed);
    std::ostringstream out, err;
    const int code = run_eval(options, out, err);
    return {code, out.str(), err.str()};
  }

  TemporaryFolder folder_;
  std::string truth_, estimate_;
};

TEST_F(EvalCommand, reads_kitti_with_a_rate_and_pairs_by_number_without) {
  std::string rows;
  for (int i = 0; i < 20; ++i) rows += "1 0 0 " + std::to_string(i * i) + " 0 1 0 " + std::to_string(i) + " 0 0 1 0\n";
  const std::string file = folder_.write("00.txt", rows);
  const Outcome outcome = run({file, file, "--rate", "10"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("(20 poses)"));
  EXPECT_EQ(run({file, file}).code, 0);
  EXPECT_THAT(run({file, file}).err, HasSubstr("note: no stamps: pose i belongs to pose i, at 10 Hz (--rate HZ)"));
  const std::string stamped = folder_.write("stamped.txt", tum_text(winding_path(20, 0.1)));
  EXPECT_THAT(run({file, stamped}).out, HasSubstr(" 20\n")) << "all are pairs";
  EXPECT_EQ(run({file, truth_}).code, 2);
  EXPECT_THAT(run({file, truth_}).err, AllOf(HasSubstr("00.txt"), HasSubstr("20 poses"), HasSubstr("--rate HZ")));
  const Outcome needless = run({estimate_, truth_, "--rate", "10"});
  EXPECT_EQ(needless.code, 2);
  EXPECT_THAT(needless.err, HasSubstr("both files have stamps"));
}

/// Motion capture has the markers on a camera: here the input of the field that shows it.
TEST_F(EvalCommand, says_that_a_ground_truth_is_of_another_body_and_compares_the_motion_of_the_camera) {
  const Eigen::Isometry3d T_markers_camera =
      Eigen::Translation3d(0.03, -0.05, 0.1) * Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, 2, -1).normalized());
  const Trajectory markers = winding_path(200, 0.1);
  Trajectory camera = markers;
  for (StampedPose& pose : camera) pose.T_world_body = pose.T_world_body * T_markers_camera;
  const std::string truth = folder_.write("markers.txt", tum_text(markers));
  const std::string estimate = folder_.write("camera.txt", tum_text(moved(camera, some_transform())));
  const Outcome outcome = run({estimate, truth});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("the ground truth is of another body"), HasSubstr("120.3 degrees")));
  const auto json = nlohmann::json::parse(run({estimate, truth, "--json"}).out);
  EXPECT_LT(json["rpe"]["per_second"]["rotation_deg"]["rmse"].get<double>(), 0.01) << "of the camera";
  EXPECT_THAT(run({truth, truth}).err, Not(HasSubstr("another body")));
}

TEST_F(EvalCommand, two_poses_have_no_error_of_a_trajectory) {
  const std::string two = folder_.write("two.txt", tum_text(winding_path(2, 0.1)));
  const Outcome outcome = run({two, truth_});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("ATE (SE(3))            no pairs"), Not(HasSubstr("drift"))));
  EXPECT_THAT(outcome.err, HasSubstr("only 2 poses have a true one, and any 2 fit each other: no ATE"));
}

TEST_F(EvalCommand, prints_a_table_with_all_errors_and_units) {
  const Outcome outcome = run({estimate_, truth_});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("ATE (SE(3))"), HasSubstr("RPE per second"), HasSubstr("RPE per frame"),
                                 HasSubstr("RPE per metre"), HasSubstr("deg"), HasSubstr("(50 poses)")));
  EXPECT_THAT(outcome.out, HasSubstr("without poses        1.90 s to 3.00 s after the start"));
}

TEST_F(EvalCommand, scale_option_aligns_with_a_similarity) {
  const auto rigid = nlohmann::json::parse(run({estimate_, truth_, "--json"}).out);
  const auto similar = nlohmann::json::parse(run({estimate_, truth_, "--json", "--scale"}).out);
  EXPECT_GT(rigid["ate_m"]["rmse"].get<double>(), 0.1);
  EXPECT_LT(similar["ate_m"]["rmse"].get<double>(), 1e-6);
  EXPECT_NEAR(similar["alignment"]["scale"].get<double>(), 2.0, 1e-6);
}

TEST_F(EvalCommand, prints_drift_and_what_a_constant_quotient_means) {
  Trajectory truth = winding_path(60, 0.1), wrong;
  for (StampedPose& pose : truth) {
    pose.T_world_body.setIdentity();
    const double way_m = 0.02 * static_cast<double>(wrong.size());
    wrong.push_back({pose.stamp_ns, Eigen::Translation3d(way_m, 0, 0) *
                                        Eigen::AngleAxisd(-std::atan2(way_m, 3), Eigen::Vector3d::UnitY())});
  }
  const std::string rest = folder_.write("rest.txt", tum_text(truth));
  const std::string estimate = folder_.write("wrong.txt", tum_text(wrong));
  EXPECT_THAT(run({estimate, rest}).out,
              AllOf(HasSubstr("drift quotient"), HasSubstr("m/rad"), HasSubstr("follows something nearer than that"),
                    Not(HasSubstr("scene's depth")), Not(HasSubstr("ok, but wrong"))));
  EXPECT_THAT(run({estimate, rest, "--scene-depth", "3"}).out, HasSubstr("the scene's depth is 3.0 m, near that"));
  const auto json = nlohmann::json::parse(run({estimate, rest, "--json"}).out);
  EXPECT_NEAR(json["drift"]["quotient_m_per_rad"].get<double>(), 3, 0.3);
  EXPECT_EQ(json["drift"]["nearly_constant"], true);
  EXPECT_TRUE(json["integrity"].is_null());
}

TEST_F(EvalCommand, json_has_every_measure) {
  const Outcome outcome = run({estimate_, truth_, "--json"});
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["ate_m"]["count"], 50);
  EXPECT_EQ(json["estimate_poses"], 50);
  EXPECT_EQ(json["groundtruth_poses"], 60);
  for (const char* unit : {"per_second", "per_frame", "per_metre"}) {
    EXPECT_TRUE(json["rpe"][unit]["translation_m"]["rmse"].is_number()) << unit;
    EXPECT_TRUE(json["rpe"][unit]["rotation_deg"]["rmse"].is_number()) << unit;
  }
  EXPECT_EQ(json["coverage"]["of"], "groundtruth_span");
  EXPECT_NEAR(json["coverage"]["fraction"].get<double>(), 48.0 / 59, 1e-6);
  EXPECT_EQ(json["coverage"]["lost_spans"].size(), 1U);
}

TEST_F(EvalCommand, several_estimates_share_a_table_a_json_and_a_plot) {
  const std::string same = folder_.write("same.txt", tum_text(winding_path(60, 0.1)));
  const std::string svg_file = folder_.file("all.svg");
  const Outcome outcome = run({estimate_, same, estimate_, truth_, "--plot", svg_file});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("ATE rmse"), HasSubstr("\n" + estimate_), HasSubstr("\n" + same)));
  const std::string svg = read_text(svg_file);
  EXPECT_THAT(svg, AllOf(HasSubstr(same + ": ATE RMSE 0.00 mm"), HasSubstr(estimate_ + ": ATE RMSE"),
                         HasSubstr("ground truth"), Not(HasSubstr("nan"))));
  const auto json = nlohmann::json::parse(run({estimate_, same, truth_, "--json"}).out);
  const auto alone = nlohmann::json::parse(run({estimate_, truth_, "--json"}).out);
  EXPECT_EQ(json["estimates"][0]["ate_m"], alone["ate_m"]);
  EXPECT_EQ(json["estimates"][1]["estimate"], same);
}

TEST_F(EvalCommand, an_estimate_of_less_than_a_second_has_no_error_per_second_in_the_table) {
  const std::string brief = folder_.write("brief.txt", tum_text(winding_path(5, 0.1)));
  EXPECT_THAT(run({estimate_, brief, truth_}).out,
              AllOf(Not(HasSubstr("nan")), HasSubstr("0.0000         -         -\n")));
}

TEST_F(EvalCommand, one_estimate_of_several_without_pairs_is_named_and_the_others_are_judged) {
  Trajectory later = winding_path(60, 0.1);
  for (StampedPose& pose : later) pose.stamp_ns += 5'000'000'000'000;
  const std::string other = folder_.write("other.txt", tum_text(later));
  const Outcome outcome = run({estimate_, other, truth_});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("estimate     " + other), HasSubstr("--offset")));
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("\n" + estimate_), HasSubstr("no ATE")));
  EXPECT_EQ(run({estimate_, folder_.file("missing.txt"), truth_}).code, 2);
}

TEST_F(EvalCommand, frame_list_gives_the_coverage_of_frames) {
  std::string list = "# colour images\n";
  for (int i = 0; i < 60; ++i)
    list += std::to_string(100 + i / 10) + "." + std::to_string(i % 10) + " rgb/" + std::to_string(i) + ".png\n";
  const std::string frames = folder_.write("rgb.txt", list);
  const auto json = nlohmann::json::parse(run({estimate_, truth_, "--json", "--frames", frames}).out);
  EXPECT_EQ(json["coverage"]["frames"], 60);
  EXPECT_EQ(json["coverage"]["tracked"], 50);
  EXPECT_EQ(json["coverage"]["lost_spans"][0]["frames"], 10);
}

TEST_F(EvalCommand, coverage_of_a_run_is_that_of_its_report) {
  eval::Run run_of_folder = testing_support::fabricated_run();  // 94 of 100 frames have a pose
  run_of_folder.frames_left_out = 88;
  run_record::write_run_json(run_of_folder, folder_.file("run.json"));
  const std::string truth = folder_.write("truth.txt", tum_text(winding_path(100, 0.1)));
  const std::string estimate = folder_.write("trajectory.txt", tum_text(online_trajectory(run_of_folder)));
  const auto json = nlohmann::json::parse(run({estimate, truth, "--json"}).out);
  EXPECT_EQ(json["coverage"]["of"], "frames");
  EXPECT_EQ(json["coverage"]["frames"], 188);
  EXPECT_DOUBLE_EQ(json["coverage"]["fraction"], summarize_run(run_of_folder).coverage);
  EXPECT_THAT(run({estimate, truth}).out, HasSubstr("coverage               50.00 % (94 of 188 frames)"));
}

TEST_F(EvalCommand, without_frames_the_share_of_time_is_not_called_coverage) {
  EXPECT_THAT(run({estimate_, truth_}).out,
              AllOf(HasSubstr("time with poses        81.36 % of the ground truth's"), Not(HasSubstr("coverage   "))));
}

TEST_F(EvalCommand, a_title_and_rows_of_nan_are_left_out_and_named) {
  const std::string rows = "timestamp tx ty tz qx qy qz qw\n99.9 nan nan nan nan nan nan nan\n";
  const std::string truth = folder_.write("mocap.txt", rows + tum_text(winding_path(60, 0.1)));
  const Outcome outcome = run({estimate_, truth});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("mocap.txt: 1 title line"), HasSubstr("mocap.txt: 1 row of nan left out")));
}

TEST_F(EvalCommand, a_few_broken_rows_are_named_and_end_with_exit_3) {
  const std::string truth = folder_.write("cut.txt", tum_text(winding_path(60, 0.1)) + "105.95 1 2\n");
  const Outcome outcome = run({estimate_, truth});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("left out: 1 row that cannot be read, first: "));
}

TEST_F(EvalCommand, ground_truth_in_millimetres_is_named) {
  const Trajectory path = winding_path(60, 0.1);
  const std::string truth = folder_.write("mm.txt", tum_text(moved(path, some_transform(), 1000)));
  const std::string estimate = folder_.write("m.txt", tum_text(path));
  EXPECT_THAT(run({estimate, truth}).err, HasSubstr("note: the ground truth seems to be in mm (scale 1000)"));
  EXPECT_THAT(run({estimate, estimate}).err, IsEmpty());
}

TEST_F(EvalCommand, offset_moves_the_estimate_in_time) {
  Trajectory late = winding_path(60, 0.1);
  for (auto& pose : late) pose.stamp_ns += 7'000'000'000'000;
  const std::string estimate = folder_.write("late.txt", tum_text(late));
  EXPECT_EQ(run({estimate, truth_}).code, 1);
  EXPECT_EQ(run({estimate, truth_, "--offset", "-7000"}).code, 0);
}

TEST_F(EvalCommand, no_pairs_is_exit_1_and_reports_both_spans_and_options) {
  Trajectory other = winding_path(10, 0.1);
  for (auto& pose : other) pose.stamp_ns += 5'000'000'000'000;
  const Outcome outcome = run({folder_.write("other.txt", tum_text(other)), truth_});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("5100.000000 to 5100.900000"), HasSubstr("100.000000 to 105.900000"),
                                 HasSubstr("--offset"), HasSubstr("-5000.000000 s")));
}

TEST_F(EvalCommand, missing_and_malformed_files_are_exit_2_with_cause_and_place) {
  const Outcome missing = run({folder_.file("nowhere.txt"), truth_});
  EXPECT_EQ(missing.code, 2);
  EXPECT_THAT(missing.err, AllOf(HasSubstr("nowhere.txt"), HasSubstr("No such file")));
  const Outcome malformed = run({estimate_, folder_.write("bad.txt", "1 0 0 0 0 0 0 1\n2 0 0\n")});
  EXPECT_EQ(malformed.code, 2);
  EXPECT_THAT(malformed.err, AllOf(HasSubstr("bad.txt:2"), HasSubstr("3 columns instead of 8")));
}

TEST_F(EvalCommand, plot_is_a_standalone_svg) {
  const std::string plot = folder_.file("plot.svg");
  EXPECT_EQ(run({estimate_, truth_, "--plot", plot}).code, 0);
  const std::string svg = read_text(plot);
  EXPECT_THAT(svg, AllOf(HasSubstr("<?xml"), HasSubstr("<polyline"), HasSubstr("ground truth"), HasSubstr("</svg>"),
                         Not(HasSubstr("nan")), Not(HasSubstr("href"))));
}

TEST_F(EvalCommand, plot_that_cannot_be_written_is_exit_2) {
  EXPECT_EQ(run({estimate_, truth_, "--plot", folder_.file("no_folder/plot.svg")}).code, 2);
  const Outcome other_kind = run({estimate_, truth_, "--plot", folder_.file("plot.pdf")});
  EXPECT_EQ(other_kind.code, 2);
  EXPECT_THAT(other_kind.err, HasSubstr(".svg"));
}

TEST_F(EvalCommand, refuses_a_negative_time_limit) {
  EXPECT_THROW(run({estimate_, truth_, "--max-difference", "-1"}), CLI::ValidationError);
}

TEST_F(EvalCommand, line_shaped_paths_are_reported_as_ambiguous) {
  Trajectory line;
  for (int i = 0; i < 20; ++i)
    line.push_back({(100 + i) * 1'000'000'000LL, Eigen::Isometry3d(Eigen::Translation3d(i, 0, 0))});
  const std::string path = folder_.write("line.txt", tum_text(line));
  EXPECT_THAT(run({path, path}).out, HasSubstr("one of many"));
}

}  // namespace
}  // namespace rtd::eval
