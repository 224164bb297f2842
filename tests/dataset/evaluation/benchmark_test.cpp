// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// `rtd benchmark` on a few frames of the clips of RTD_DATA_DIR, laid out as the folders of the public datasets.
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "common/io/input_file.hpp"
#include "common/io/text.hpp"
#include "tests/support/run_command.hpp"

namespace rtd {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kFrames = 12;

class BenchmarkCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("RTD_DATA_DIR");
    for (const char* clip : {"fr1_xyz", "walk_xyz"}) {
      if (data == nullptr || !fs::exists(fs::path(data) / clip)) GTEST_SKIP() << "RTD_DATA_DIR has no " << clip;
    }
    clips_ = data;
    scratch_ = fs::path(::testing::TempDir()) / ("rtd_benchmark_" + std::to_string(getpid()));
    fs::create_directories(scratch_ / "data");
  }
  void TearDown() override {
    if (!HasFailure() && !scratch_.empty()) fs::remove_all(scratch_);
  }

  /// The first images of walk_xyz that a list names, and their part of the list: data sets hold what they name.
  void copy_images(const std::string& list, const fs::path& folder, const std::string& images,
                   const std::string& to) const {
    fs::create_directories(folder / images);
    std::ofstream copied(folder / to);
    const auto lines = io::split_lines(io::try_read_file(clips_ / "walk_xyz" / list, io::kFrameList).value());
    for (std::size_t i = 0; i < kFrames; ++i) {
      const auto& fields = lines.at(i).fields;
      const std::string file = images + "/" + fs::path(fields[1]).filename().string();
      fs::copy_file(clips_ / "walk_xyz" / fields[1], folder / file);
      copied << fields[0] << ' ' << file << '\n';
    }
  }
  /// The first frames of walk_xyz as a Bonn sequence: without its calibration.
  void lay_out_bonn(const std::string& name) const {
    for (const std::string part : {"rgb", "depth"}) copy_images(part + ".txt", data(name), part, part + ".txt");
    fs::copy_file(clips_ / "walk_xyz/groundtruth.txt", data(name) / "groundtruth.txt");
  }
  /// The first frames of walk_xyz as an OpenLORIS-Scene sequence: depth in millimetres, calibration in OpenCV's YAML.
  void lay_out_openloris(const std::string& name) const {
    copy_images("associations.txt", data(name), "color", "color.txt");
    fs::create_directories(data(name) / "aligned_depth");
    fs::copy_file(clips_ / "walk_xyz/groundtruth.txt", data(name) / "groundtruth.txt");
    std::ofstream depth(data(name) / "aligned_depth.txt");
    const auto lines = io::split_lines(io::try_read_file(clips_ / "walk_xyz/associations.txt", io::kFrameList).value());
    for (int i = 0; i < kFrames; ++i) {
      const auto& fields = lines.at(static_cast<std::size_t>(i)).fields;
      const std::string file = "aligned_depth/" + fs::path(fields[3]).filename().string();
      cv::Mat depth_mm = cv::imread((clips_ / "walk_xyz" / fields[3]).string(), cv::IMREAD_UNCHANGED) / 5;
      cv::imwrite((data(name) / file).string(), depth_mm);
      depth << fields[2] << ' ' << file << '\n';
    }
    std::ofstream(data(name) / "sensors.yaml")
        << "%YAML:1.0\nd400_color_optical_frame:\n   fps: 30\n   width: 640\n   height: 480\n"
           "   intrinsics: !!opencv-matrix\n      rows: 1\n      cols: 4\n      dt: d\n"
           "      data: [ 535.4, 320.1, 539.2, 247.6 ]\n";
    std::ofstream(data(name) / "trans_matrix.yaml")
        << "%YAML:1.0\ntrans_matrix:\n   -\n      parent_frame: base_link\n      child_frame: "
           "d400_color_optical_frame\n"
           "      matrix: !!opencv-matrix\n         rows: 4\n         cols: 4\n         dt: d\n"
           "         data: [ 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1. ]\n";
  }

  /// One run of each mode without a network; the exit code.
  int run(const std::string& dataset, const std::string& more = "") {
    const testing::CommandResult result = testing::run_command(
        "timeout 300 " RTD_EVAL_EXECUTABLE " benchmark " + dataset + " " + (scratch_ / "data").string() +
        " --detector off --modes off,geometry --runs 1 --jobs 2 --domain 119 --frames " + std::to_string(kFrames) + " --out " + out().string() + " " + more);
    output_ = result.output;
    return result.exit_code;
  }
  nlohmann::json results() const {
    return nlohmann::json::parse(io::try_read_file(out() / "benchmark.json", io::kResults).value());
  }
  std::string page() const { return io::try_read_file(out() / "benchmark.html", io::kResults).value_or(""); }
  fs::path data(const std::string& name) const { return scratch_ / "data" / name; }
  fs::path out() const { return scratch_ / "out"; }

  fs::path clips_, scratch_;
  std::string output_;
};

TEST_F(BenchmarkCommand, measures_a_tum_sequence_once_and_keeps_its_runs) {
  fs::create_symlink(clips_ / "fr1_xyz", data("rgbd_dataset_freiburg1_xyz"));
  ASSERT_EQ(run("tum"), 0) << output_;
  EXPECT_THAT(output_, AllOf(HasSubstr("fr1_xyz, off: ATE"), HasSubstr("fr1_xyz, geometry: ATE")));
  const nlohmann::json json = results();
  ASSERT_EQ(json["rows"].size(), 2U);
  const nlohmann::json figures = json["rows"][1]["figures"];
  EXPECT_LT(figures["ate_m"]["median"], 0.02);
  EXPECT_GT(figures["slam_ms"]["median"], 0);
  EXPECT_NEAR(figures["share.ok"]["median"].get<double>() + figures["share.lost"]["median"].get<double>() +
                  figures["share.doubtful"]["median"].get<double>() +
                  figures["share.predicted"]["median"].get<double>(),
              1, 1e-9);
  EXPECT_THAT(page(), HasSubstr("fr1_xyz"));

  const std::string compare = " --compare " + (out() / "benchmark.json").string();
  ASSERT_EQ(run("tum", compare), 0) << output_;
  EXPECT_THAT(output_, AllOf(HasSubstr("runs to do: 0, kept from earlier calls: 2"), HasSubstr("+0 %")));
  ASSERT_EQ(run("tum", "--set filter.orb.feature_count=700"), 0) << output_;
  EXPECT_THAT(output_, HasSubstr("other options")) << "they are made again";
  EXPECT_TRUE(fs::exists(out() / "benchmark.previous.json"));
}

TEST_F(BenchmarkCommand, knows_the_camera_of_bonn_and_continues_without_incomplete_sequences) {
  lay_out_bonn("rgbd_bonn_crowd");
  lay_out_bonn("rgbd_bonn_balloon");
  fs::remove(data("rgbd_bonn_balloon") / "groundtruth.txt");
  EXPECT_EQ(run("bonn"), 3) << output_;
  EXPECT_THAT(output_, AllOf(HasSubstr("rgbd_bonn_balloon is left out: it has no groundtruth.txt"),
                             HasSubstr("crowd, geometry: ATE 0.0"), Not(HasSubstr("failed"))));
  EXPECT_EQ(results()["left_out"].size(), 1U);
}

TEST_F(BenchmarkCommand, reads_the_layout_of_openloris) {
  lay_out_openloris("cafe1-1");
  EXPECT_EQ(run("openloris"), 0) << output_;
  EXPECT_LT(results()["rows"][1]["figures"]["ate_m"]["median"], 0.02) << output_;
}

TEST_F(BenchmarkCommand, starts_nothing_without_sequences_or_with_wrong_words) {
  EXPECT_EQ(run("tum"), 2);
  EXPECT_THAT(output_, HasSubstr("rgbd_dataset_freiburgN_NAME"));
  EXPECT_EQ(run("tum", "--modes geometri"), 2);
  EXPECT_EQ(run("kitti"), 2);
}

}  // namespace
}  // namespace rtd
