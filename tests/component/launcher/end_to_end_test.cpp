// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/component/launcher/rtd_command.hpp"
#include "tests/support/sanitizers.hpp"
#include "tests/support/time_bounds.hpp"

namespace rtd::launcher {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

/// The real services over Fast DDS. Every test has a DDS domain of its own.
class EndToEndTest : public testing::Test {
 protected:
  std::vector<std::string> arguments(int domain, const std::string& source, const std::vector<std::string>& more = {}) {
    std::vector<std::string> all = {"run", "--source", source, "--out", out_, "--domain", std::to_string(domain)};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  nlohmann::json report() { return nlohmann::json::parse(text_of(out_ + "/report.json")); }
  /// Inputs as others have them; empty where they are not.
  static std::string field2(const std::string& name) {
    const char* const data = std::getenv("RTD_DATA_DIR");
    const fs::path file = fs::path(data == nullptr ? "" : data) / "field2" / name;
    return fs::exists(file) ? file.string() : "";
  }
  bool wait_for_log(const std::string& service, const std::string& text) {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (std::chrono::steady_clock::now() < give_up) {
      rtd_.wait_for("never printed", std::chrono::milliseconds(50));
      if (text_of(out_ + "/logs/" + service + ".log").find(text) != std::string::npos) return true;
    }
    return false;
  }
  /// Waits until the camera's log says that frames are being sent.
  bool wait_for_frames() { return wait_for_log("camera", "event=all_ready"); }
  pid_t pid_of(const std::string& service) { return pid_in(text_of(out_ + "/logs/" + service + ".log")); }

  ScratchFolder scratch_;
  std::string out_ = scratch_ / "out";
  RtdCommand rtd_;
};

TEST_F(EndToEndTest, a_lockstep_run_tracks_every_frame_and_reports_every_key) {
  ASSERT_EQ(rtd_.run(arguments(61, "synthetic:office?frames=30", {"--pace", "lockstep"})), 0) << rtd_.output();
  const nlohmann::json json = report();
  for (const char* key : {"frames_in", "frames_tracked", "frames_dropped", "coverage", "ate_rmse_m", "rpe_trans_rmse_m",
                          "rpe_rot_rmse_deg", "latency_ms", "stage_ms", "cpu_s", "peak_rss_mb"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  for (const char* key : {"p50", "p99", "max"}) EXPECT_GT(json["latency_ms"][key], 0.0) << key;
  for (const char* process : {"camera", "filter", "slam", "launcher"}) {
    EXPECT_GT(json["cpu_s"][process], 0.0) << process;
    EXPECT_GT(json["peak_rss_mb"][process], 1.0) << process;
  }
  double services_mb = -json["peak_rss_mb"]["launcher"].get<double>();
  for (const auto& [process, peak_mb] : json["peak_rss_mb"].items()) services_mb += peak_mb.get<double>();
  EXPECT_LT(services_mb, test_support::kSanitized ? 3000 : 330) << "287 MB with detector when this was written";
  EXPECT_EQ(json["frames_in"], 30);
  EXPECT_EQ(json["frames_dropped"], 0);
  EXPECT_GE(json["coverage"], 0.96);
  EXPECT_LT(json["ate_rmse_m"], 0.05);
  for (const char* file : {"trajectory.txt", "trajectory_online.txt", "keyframes.txt", "map.ply", "groundtruth.txt",
                           "report.html", "logs/camera.log", "logs/filter.log", "logs/slam.log"}) {
    EXPECT_GT(fs::file_size(out_ + "/" + file), 0U) << file;
  }
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("30 given, 30 used, "), HasSubstr("ATE rmse"), HasSubstr("report.html")));
}

/// `rtd export` of a run gives every keyframe, with its mask, where keyframes.txt says that it was.
void expect_exported_keyframes(const std::string& run, const std::string& out) {
  RtdCommand rtd;
  ASSERT_EQ(rtd.run({"export", run, "--nerfstudio", out}), 0) << rtd.output();
  const nlohmann::json frames = nlohmann::json::parse(text_of(out + "/transforms.json"))["frames"];
  std::istringstream keyframes(text_of(run + "/keyframes.txt"));
  std::size_t i = 0;
  for (std::string line; std::getline(keyframes, line); ++i) {
    std::istringstream row(line);
    double value = 0;
    row >> value;  // the stamp
    ASSERT_LT(i, frames.size());
    for (int axis = 0; row && axis < 3; ++axis) {
      row >> value;
      EXPECT_NEAR(frames[i]["transform_matrix"][axis][3], value, 1e-6) << line;
    }
    EXPECT_TRUE(fs::exists(out + "/" + frames[i]["mask_path"].get<std::string>()));
  }
  EXPECT_EQ(i, frames.size());
  EXPECT_GT(i, 1U);
}

TEST_F(EndToEndTest, a_dense_map_a_recording_and_a_trace_change_nothing_of_the_run) {
  const std::vector<std::string> lockstep = {"--pace", "lockstep", "--detector", "off"};
  ASSERT_EQ(rtd_.run(arguments(69, "synthetic:office?frames=30", lockstep)), 0) << rtd_.output();
  const std::string without = text_of(out_ + "/trajectory.txt");
  EXPECT_TRUE(report()["static_map"].is_null());
  RtdCommand dense;
  std::vector<std::string> command = arguments(69, "synthetic:office?frames=30", lockstep);
  command.insert(command.end(), {"--dense", "--record", scratch_ / "run.mcap", "--trace", scratch_ / "trace.json"});
  ASSERT_EQ(dense.run(command), 0) << dense.output();
  EXPECT_EQ(text_of(out_ + "/trajectory.txt"), without) << "byte for byte";
  EXPECT_THAT(dense.output(), HasSubstr("static_map.ply"));
  EXPECT_GT(report()["static_map"]["points"], 5000);
  EXPECT_GT(report()["cpu_s"]["dense"], 0.0);
  EXPECT_GT(fs::file_size(scratch_ / "run.mcap"), 30U * 640 * 480 * 5) << "with all raw frames";
  EXPECT_THAT(text_of(out_ + "/logs/record.log"), HasSubstr("topic=rtd/frame messages=30 lost_in_transit=0"));
  EXPECT_FALSE(fs::exists(out_ + "/trace"));
  expect_exported_keyframes(out_, scratch_ / "splat");
  std::map<std::string, int> spans;
  const nlohmann::json trace = nlohmann::json::parse(text_of(scratch_ / "trace.json"));
  for (const nlohmann::json& event : trace["traceEvents"])
    ++spans[event["ph"] == "M" ? event["args"]["name"] : event["name"]];
  for (const char* process : {"rtd-camera", "rtd-filter", "rtd-slam", "rtd-dense", "rtd-record"})
    EXPECT_EQ(spans[process], 1) << process;
  for (const char* stage : {"extract", "judge", "wait for boxes", "slam"}) EXPECT_EQ(spans[stage], 30) << stage;
  EXPECT_GT(spans["integrate"], 5);
  EXPECT_EQ(spans["join"], 5) << "the start of each process";
  for (const char* way : {"read", "camera to pose"}) EXPECT_EQ(spans[way], 60) << way << ": begin and end";
}

TEST_F(EndToEndTest, a_run_that_used_less_than_half_of_its_frames_is_no_success) {
  RtdCommand convert;
  const std::string folder = scratch_ / "frames";
  ASSERT_EQ(convert.run({"convert", "synthetic:office?frames=12", "tum:" + folder}), 0) << convert.output();
  std::vector<fs::path> images;
  for (const auto& file : fs::directory_iterator(folder + "/rgb")) images.push_back(file.path());
  std::ranges::sort(images);
  for (std::size_t i = 4; i < images.size(); ++i) std::ofstream(images[i], std::ios::trunc);
  EXPECT_EQ(rtd_.run(arguments(74, "tum:" + folder, {"--pace", "lockstep", "--detector", "off"})), 3);
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("only 4 of 12 frames were used; 8 x color_unreadable: colour images are"),
                                   HasSubstr("12 given, 4 used, 4 with pose  (color_unreadable 8)")));
  EXPECT_NEAR(report()["coverage"], 1.0 / 3, 1e-9);
}

TEST_F(EndToEndTest, a_recording_brings_its_imu_and_its_transforms) {
  const char* const data = std::getenv("RTD_DATA_DIR");
  const fs::path recording = fs::path(data == nullptr ? "" : data) / "field/recording_with_imu_and_tf/imu_tf.mcap";
  if (!fs::exists(recording)) GTEST_SKIP() << "RTD_DATA_DIR has no field/recording_with_imu_and_tf";
  const std::vector<std::string> motion = {"--detector", "off", "--imu", "/camera/imu", "--camera-in-base", "tf"};
  ASSERT_EQ(rtd_.run(arguments(58, "mcap:" + recording.string(), motion)), 0) << rtd_.output();
  EXPECT_EQ(report()["frames_tracked"], 6);
}

TEST_F(EndToEndTest, of_two_cameras_on_one_topic_one_is_followed_and_that_is_no_success) {
  const std::string source = field2("two_cameras_one_topic/a.mcap");
  if (source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no field2";
  EXPECT_EQ(rtd_.run(arguments(58, source, {"--detector", "off"})), 3) << rtd_.output();
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("only 10 of 20 frames were used; 10 x other_camera: two cameras send"),
                                   HasSubstr("'front_color_optical_frame' and 'rear_color_optical_frame'")));
}

TEST_F(EndToEndTest, images_that_come_twice_count_once) {
  const std::string source = field2("every_image_twice/a.mcap");
  if (source.empty()) GTEST_SKIP() << "RTD_DATA_DIR has no field2";
  EXPECT_EQ(rtd_.run(arguments(58, source, {"--detector", "off"})), 0) << rtd_.output();
  EXPECT_THAT(rtd_.output(), HasSubstr("6 given, 6 used, 6 with pose  (repeated 6)"));
  EXPECT_EQ(report()["coverage"], 1.0);
}

TEST_F(EndToEndTest, a_recording_without_people_hides_what_no_detector_has_seen) {
  const std::vector<std::string> quick = {"--pace", "lockstep", "--detector", "off", "--blur-people"};
  EXPECT_EQ(rtd_.run(arguments(69, "synthetic:office?frames=3", quick)), 2);
  EXPECT_THAT(rtd_.output(), HasSubstr("--blur-people is for what --record FILE records"));
  std::vector<std::string> recorded = quick;
  recorded.insert(recorded.end(), {"--record", scratch_ / "run.mcap"});
  ASSERT_EQ(rtd_.run(arguments(69, "synthetic:office?frames=3", recorded)), 0) << rtd_.output();
  EXPECT_THAT(text_of(out_ + "/logs/record.log"),
              AllOf(HasSubstr("event=people_blurred images=0 hidden="), HasSubstr("event=images_hidden")));
}

TEST_F(EndToEndTest, a_trace_that_cannot_be_written_is_refused_before_the_run) {
  EXPECT_EQ(rtd_.run(arguments(69, "synthetic:office?frames=5", {"--trace", scratch_ / "none/trace.json"})), 2);
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("--trace"), HasSubstr("no such folder")));
}

TEST_F(EndToEndTest, a_second_run_into_the_same_folder_is_refused_and_deletes_nothing) {
  rtd_.start(arguments(72, "synthetic:office?frames=0", {"--detector", "off"}));
  ASSERT_TRUE(wait_for_frames()) << rtd_.output();
  const std::string pid = std::to_string(rtd_.process());
  RtdCommand second, ablation;
  EXPECT_EQ(second.run(arguments(73, "synthetic:office?frames=5")), 2);
  EXPECT_THAT(second.output(),
              AllOf(HasSubstr("--out " + out_), HasSubstr("process " + pid), HasSubstr("another folder")));
  EXPECT_EQ(ablation.run({"ablate", "--source", "synthetic:office?frames=5", "--out", out_, "--domain", "73"}), 2);
  EXPECT_THAT(ablation.output(), HasSubstr("process " + pid));
  EXPECT_TRUE(fs::exists(out_ + "/logs/slam.log"));
  rtd_.interrupt();
  EXPECT_EQ(rtd_.wait(), 130) << rtd_.output();
  EXPECT_TRUE(fs::exists(out_ + "/report.json"));
  RtdCommand third;
  EXPECT_EQ(third.run(arguments(72, "synthetic:office?frames=10", {"--pace", "lockstep", "--detector", "off"})), 0)
      << third.output();
}

TEST_F(EndToEndTest, files_that_a_run_clears_are_not_reached_through_links) {
  fs::create_directories(scratch_ / "elsewhere");
  std::ofstream(scratch_ / "elsewhere/notes") << "mine";
  fs::create_directories(out_);
  fs::create_symlink(scratch_ / "elsewhere", out_ + "/logs");
  fs::create_symlink(scratch_ / "elsewhere/notes", out_ + "/trajectory.txt");
  ASSERT_EQ(rtd_.run(arguments(72, "synthetic:office?frames=10", {"--pace", "lockstep", "--detector", "off"})), 0)
      << rtd_.output();
  EXPECT_EQ(text_of(scratch_ / "elsewhere/notes"), "mine");
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch_ / "elsewhere"), fs::directory_iterator()), 1);
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(out_ + "/trajectory.txt")));
}

TEST_F(EndToEndTest, a_run_whose_output_is_not_read_continues_to_its_report) {
  RtdCommand shell("/bin/sh");
  const std::string rtd = RTD_EXECUTABLE;
  const std::string run =
      rtd + " run --source 'synthetic:office?frames=20' --pace lockstep --detector off --domain 74 --out " + out_;
  ASSERT_EQ(shell.run({"-c", "{ " + run + " 2>&1; echo $? >" + out_ + "/code; } | head -1"}), 0) << shell.output();
  EXPECT_EQ(text_of(out_ + "/code"), "0\n");
  EXPECT_EQ(report()["frames_in"], 20);
  EXPECT_TRUE(fs::exists(out_ + "/report.html"));
  ASSERT_EQ(shell.run({"-c", run + " >&- 2>&-"}), 0) << "closed, not only unread";
  EXPECT_EQ(report()["frames_in"], 20);
}

TEST_F(EndToEndTest, a_slam_killed_during_the_run_continues_with_its_last_checkpoint) {
  rtd_.start(arguments(70, "synthetic:office?frames=180", {"--detector", "off", "--set", "slam.map.checkpoint_s=0.2"}));
  ASSERT_TRUE(wait_for_frames()) << rtd_.output();
  ASSERT_TRUE(wait_for_log("slam", "event=map_saved")) << rtd_.output();
  ASSERT_EQ(send_signal(pid_of("slam"), SIGKILL), 0);
  EXPECT_EQ(rtd_.wait(), 0) << rtd_.output();
  EXPECT_THAT(rtd_.output(), HasSubstr("the map from its last checkpoint"));
  const std::string log = text_of(out_ + "/logs/slam.log");
  EXPECT_THAT(log, AllOf(HasSubstr("event=map_loaded"), HasSubstr("event=relocalized"), HasSubstr("occasion=end")));
  if (test_support::kSanitized) GTEST_SKIP() << test_support::kTooSlow;
  EXPECT_GT(report()["frames_tracked"], 60) << "before and after";
  const std::string trajectory = text_of(out_ + "/trajectory.txt");
  EXPECT_TRUE(trajectory.starts_with(text_of(out_ + "/trajectory_online.txt").substr(0, 40)))
      << "with the poses before";
  EXPECT_THAT(report()["events"].dump(), HasSubstr("slam was restarted with its map"));
}

TEST_F(EndToEndTest, a_second_run_finds_its_place_in_the_map_of_the_first) {
  const std::vector<std::string> quick = {"--pace", "lockstep", "--detector", "off"};
  ASSERT_EQ(rtd_.run(arguments(71, "synthetic:office?frames=30", quick)), 0) << rtd_.output();
  const std::string map = out_ + "/map.rtdmap", before = text_of(map);
  RtdCommand info, second;
  EXPECT_EQ(info.run({"map", "info", map}), 0) << info.output();
  EXPECT_THAT(info.output(), HasSubstr("checksums all right"));
  std::vector<std::string> command = arguments(71, "synthetic:office?frames=30", quick);
  command.insert(command.end(), {"--map", map, "--localize-only"});  // the same folder: the map is not cleared away
  ASSERT_EQ(second.run(command), 0) << second.output();
  EXPECT_GE(report()["coverage"], 0.93) << "two of 30 frames may go by until a place is believed";
  EXPECT_EQ(text_of(map), before);
  RtdCommand refused;
  EXPECT_EQ(refused.run(arguments(71, "synthetic:office?frames=30", {"--map", scratch_ / "none.rtdmap"})), 2);
  EXPECT_THAT(refused.output(), HasSubstr("none.rtdmap: no such file"));
}

TEST_F(EndToEndTest, a_filter_killed_during_the_run_is_restarted_and_the_run_completes) {
  rtd_.start(arguments(62, "synthetic:office?frames=150", {"--detector", "off"}));
  ASSERT_TRUE(wait_for_frames()) << rtd_.output();
  rtd_.wait_for("never printed", std::chrono::seconds(1));
  ASSERT_EQ(send_signal(pid_of("filter"), SIGKILL), 0);
  EXPECT_EQ(rtd_.wait(), 0) << rtd_.output();
  EXPECT_THAT(rtd_.output(),
              AllOf(HasSubstr("filter died: killed by signal 9 (SIGKILL)"), HasSubstr("filter restarted (1st time)")));
  const nlohmann::json json = report();
  EXPECT_EQ(json["frames_in"], 150);
  EXPECT_EQ(json["frames_dropped"], 0) << "what was under way is sent again";
  if (test_support::kSanitized) GTEST_SKIP() << test_support::kTooSlow;
  EXPECT_GT(json["frames_tracked"], 60) << "the restarted filter serves again";
}

TEST_F(EndToEndTest, a_slam_that_hangs_is_killed_and_finds_its_place_again) {
  rtd_.start(arguments(81, "synthetic:office?frames=0",
                       {"--detector", "off", "--set", "launcher.hung_after_ms=2000", "slam.map.checkpoint_s=0.2"}));
  ASSERT_TRUE(wait_for_log("slam", "event=map_saved")) << rtd_.output();
  ASSERT_EQ(send_signal(pid_of("slam"), SIGSTOP), 0);
  ASSERT_TRUE(rtd_.wait_for("slam hung for 2 s and was killed")) << rtd_.output();
  EXPECT_TRUE(wait_for_log("slam", "event=relocalized")) << rtd_.output();
  rtd_.interrupt();
  EXPECT_EQ(rtd_.wait(), 130);
  EXPECT_THAT(rtd_.output(), testing::Not(AnyOf(HasSubstr("filter hung"), HasSubstr("camera hung"))));
}

TEST_F(EndToEndTest, ctrl_c_ends_an_endless_run_within_two_seconds_with_its_results) {
  rtd_.start(arguments(63, "synthetic:office?frames=0", {"--detector", "off"}));
  ASSERT_TRUE(wait_for_frames()) << rtd_.output();
  rtd_.wait_for("never printed", std::chrono::seconds(1));
  const auto pressed = std::chrono::steady_clock::now();
  rtd_.interrupt();
  EXPECT_EQ(rtd_.wait(), 130);
  const auto took = std::chrono::steady_clock::now() - pressed;
  EXPECT_THAT(rtd_.output(), testing::Not(HasSubstr("was killed"))) << "everything ends when asked";
  EXPECT_GT(fs::file_size(out_ + "/trajectory.txt"), 0U);
  EXPECT_GT(report()["frames_tracked"], 0);
  if (test_support::checks_time()) {
    EXPECT_LT(took, std::chrono::seconds(2));
  }
}

TEST_F(EndToEndTest, a_missing_folder_is_named) {
  EXPECT_EQ(rtd_.run(arguments(64, "tum:/nonexistent/folder")), 2);
  EXPECT_THAT(rtd_.output(), HasSubstr("/nonexistent/folder"));
}

TEST_F(EndToEndTest, an_unknown_key_is_refused_with_the_nearest_one) {
  EXPECT_EQ(rtd_.run(arguments(65, "synthetic:office?frames=5", {"--set", "filter.mod=rtd"})), 2);
  EXPECT_THAT(rtd_.output(), HasSubstr("did you mean 'filter.mode'?"));
}

TEST_F(EndToEndTest, without_weights_it_says_so_and_runs_on_geometry) {
  setenv("RTD_MODEL_DIR", (scratch_ / "nowhere").c_str(), 1);
  setenv("XDG_CACHE_HOME", (scratch_ / "nowhere").c_str(), 1);
  EXPECT_EQ(rtd_.run(arguments(66, "synthetic:office?frames=10", {"--pace", "asap"})), 0) << rtd_.output();
  EXPECT_THAT(rtd_.output(), HasSubstr("no detector weights"));
  EXPECT_EQ(report()["frames_tracked"], 10);
}

TEST_F(EndToEndTest, a_second_run_in_the_same_domain_is_refused_and_leaves_the_first_alone) {
  rtd_.start(arguments(68, "synthetic:office?frames=60", {"--detector", "off", "--pace", "lockstep"}));
  ASSERT_TRUE(wait_for_frames()) << rtd_.output();
  RtdCommand second;
  EXPECT_EQ(second.run({"run", "--source", "synthetic:office", "--domain", "68", "--out", scratch_ / "second"}), 2);
  // The launcher sees it, or, on a busy host where no message of the first arrives in time, the service that starts.
  EXPECT_THAT(second.output(),
              AllOf(AnyOf(HasSubstr("domain 68 is taken by"), HasSubstr("already runs in DDS domain 68")),
                    HasSubstr("--domain")));
  EXPECT_EQ(rtd_.wait(), 0) << rtd_.output();
  EXPECT_EQ(report()["frames_tracked"], 60);
}

TEST_F(EndToEndTest, the_demo_needs_no_data_and_shows_both_runs_on_one_page) {
  unsetenv("RTD_DATA_DIR");
  EXPECT_EQ(rtd_.run({"demo", "--frames", "10", "--out", out_, "--domain", "67"}), 0) << rtd_.output();
  EXPECT_THAT(rtd_.output(), AllOf(HasSubstr("synthetic:office"), HasSubstr("every point (--filter off)"),
                                   HasSubstr("static points (--filter rtd)"), HasSubstr("next:")));
  EXPECT_THAT(text_of(out_ + "/demo.html"), HasSubstr("\"kind\":\"comparison\""));
  for (const char* mode : {"off", "rtd"}) EXPECT_TRUE(fs::exists(out_ + "/" + mode + "/report.html")) << mode;
  for (const char* file : {"/off/report.html", "/rtd/map.html"})
    EXPECT_THAT(text_of(out_ + file), HasSubstr("../demo.html")) << file;
  EXPECT_THAT(text_of(out_ + "/demo.html"), AllOf(HasSubstr("off/report.html"), HasSubstr("rtd/map.html")));
}

TEST_F(EndToEndTest, the_demo_takes_a_source_and_refuses_one_that_is_not_there) {
  EXPECT_EQ(rtd_.run({"demo", "--source", "tum:holiday_video", "--out", out_, "--domain", "67"}), 2);
  EXPECT_THAT(rtd_.output(), HasSubstr("holiday_video"));
}

TEST_F(EndToEndTest, an_ablation_compares_variants_keeps_its_runs_and_refuses_unknown_techniques) {
  std::vector<std::string> ablate = {"ablate",  "--source",     "synthetic:office?frames=8",
                                     "--modes", "off,geometry", "--without",
                                     "none",    "--detector",   "off",
                                     "--out",   out_,           "--domain",
                                     "118"};
  ASSERT_EQ(rtd_.run(ablate), 0) << rtd_.output();
  EXPECT_THAT(rtd_.output(),
              AllOf(HasSubstr("[ 1/2] office, off: ATE"), HasSubstr("geometry"), HasSubstr("precision")));
  const nlohmann::json json = nlohmann::json::parse(text_of(out_ + "/ablation.json"));
  ASSERT_EQ(json["rows"].size(), 2U);
  EXPECT_GT(json["rows"][1]["figures"]["ate_m"]["median"], 0.0);
  EXPECT_NE(json["results"][1]["trajectory"], "00000000");
  EXPECT_EQ(json["complete"], true);
  EXPECT_THAT(text_of(out_ + "/ablation.html"), HasSubstr("\"kind\":\"experiment\""));
  EXPECT_THAT(text_of(out_ + "/ablation.md"), HasSubstr("| geometry |"));

  RtdCommand again, wrong;
  ablate.emplace_back("--resume");
  EXPECT_EQ(again.run(ablate), 0);
  EXPECT_THAT(again.output(), AllOf(HasSubstr("runs to do: 0, kept from earlier calls: 2"), HasSubstr("geometry")));
  EXPECT_EQ(wrong.run({"ablate", "--source", "synthetic:office?frames=8", "--without", "depth_chek", "--out", out_}),
            2);
  EXPECT_THAT(wrong.output(), HasSubstr("did you mean 'depth_check'?"));
}

}  // namespace
}  // namespace rtd::launcher
