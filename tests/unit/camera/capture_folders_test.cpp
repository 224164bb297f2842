// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Folders that no dataset's layout fits: of capture scripts, and what people point at by mistake.
#include <gmock/gmock.h>

#include <cstdlib>

#include "common/camera/folder/folder_source.hpp"
#include "common/camera/unread_forms.hpp"
#include "tests/unit/camera/data_folder.hpp"
#include "tests/unit/camera/played_frames.hpp"

namespace rtd::camera::layouts {
namespace {

namespace fs = std::filesystem;
using namespace ::testing;

TEST(CaptureFolders, names_of_capture_scripts_pair) {
  const std::vector<std::array<const char*, 4>> forms = {
      {"rgb/0001.png", "rgb/0002.png", "depth/0001.png", "depth/0002.png"},
      {"images/img_1.jpg", "images/img_10.jpg", "depths/d_1.png", "depths/d_10.png"},
      {"Color/1.png", "Color/2.png", "Depth/1.png", "Depth/2.png"},
      {"rgb_00000.png", "rgb_00001.png", "depth_00000.png", "depth_00001.png"},
      {"00000-color.png", "00001-color.png", "00000-depth.png", "00001-depth.png"},
      {"rgb/1.png", "rgb/2.png", "depth/0.png", "depth/1.png"},
      {"color_images/a.png", "color_images/b.png", "depth_images/a.png", "depth_images/b.png"},
      {"cam0/data/1403636579763555584.png", "cam0/data/1403636579813555456.png", "depth0/data/1403636579763555584.png",
       "depth0/data/1403636579813555456.png"},
      {"rgb/1620000000123.png", "rgb/1620000000156.png", "aligned_depth/1620000000124.png",
       "aligned_depth/1620000000157.png"}};
  for (const auto& [color, other_color, depth, other_depth] : forms) {
    const DataFolder folder;
    folder.color(color);
    folder.color(other_color);
    folder.depth(depth, 2001);
    folder.depth(other_depth, 3001);
    const auto frames = test::play(folder.uri(kIntrinsics));
    ASSERT_THAT(frames, SizeIs(2)) << color;
    EXPECT_NEAR(metres(frames[0]), 2.001, 1e-9) << color;
    EXPECT_NEAR(metres(frames[1]), 3.001, 1e-9) << color;
    EXPECT_GT(frames[1].image.stamp_ns, frames[0].image.stamp_ns);
  }
}

TEST(CaptureFolders, numbers_without_leading_zeros_are_in_the_order_of_numbers) {
  const DataFolder folder;
  for (int i = 1; i <= 12; ++i) {
    folder.color("rgb/" + std::to_string(i) + ".png");
    folder.depth("depth/" + std::to_string(i - 1) + ".png", 1000 + i);
  }
  const auto frames = test::play(folder.uri(kIntrinsics));
  ASSERT_THAT(frames, SizeIs(12));
  for (int i = 0; i < 12; ++i) EXPECT_NEAR(metres(frames[static_cast<std::size_t>(i)]), 1.001 + 0.001 * i, 1e-9);
}

TEST(CaptureFolders, calibration_file_gives_camera_rate_and_unit_of_a_tum_folder) {
  const DataFolder folder;
  folder.color("rgb/0.png");
  folder.color("rgb/1.png");
  folder.depth("depth/0.png");
  folder.depth("depth/1.png");
  folder.write("associations.txt", "100.0 rgb/0.png 100.0 depth/0.png\n100.1 rgb/1.png 100.1 depth/1.png\n");
  folder.write("orb2.yaml",
               "%YAML:1.0\nCamera.fx: 52\nCamera.fy: 53\nCamera.cx: 31.5\nCamera.cy: 23.5\nCamera.k1: 0.1\n"
               "Camera.width: 64\nCamera.height: 48\nCamera.fps: 10.0\nDepthMapFactor: 1000.0\nViewer.PointSize:2\n");
  const auto source = make_source(folder.uri("?calibration=orb2.yaml"));
  EXPECT_EQ(source->info().camera.parameters().distortion[0], 0.1);
  EXPECT_EQ(source->info().fps, 10);
  EXPECT_EQ(source->info().depth_scale_m, 0.001);
  EXPECT_EQ(make_source(folder.uri("?calibration=orb2.yaml&depth_factor=2000"))->info().depth_scale_m, 0.0005);
  EXPECT_TRUE(test::refuses(folder.uri("?calibration=none.yaml"), {"none.yaml cannot be read"}));
}

TEST(CaptureFolders, stamps_that_are_no_times_are_an_error_and_a_rate_replaces_them) {
  const DataFolder folder;
  std::string pairs;
  for (const char* const stamp :
       {"0.00585", "0.00706", "00.0154", "00.0148", "00.0163", "00.0162", "0.0057", "0.0055"}) {
    const std::string i = std::to_string(std::count(pairs.begin(), pairs.end(), '\n'));
    folder.color("rgb/" + i + ".png");
    folder.depth("depths/" + i + ".png");
    pairs += std::string(stamp) + " rgb/" + i + ".png " + stamp + " depths/" + i + ".png\n";
  }
  folder.write("associations.txt", pairs);
  EXPECT_TRUE(test::refuses(folder.uri(kIntrinsics), {"4 of 8", "?fps=30"}));
  const auto frames = test::play(folder.uri(std::string(kIntrinsics) + "&fps=30"));
  ASSERT_THAT(frames, SizeIs(8));
  EXPECT_EQ(frames[7].image.stamp_ns, 233'333'333);
}

TEST(CaptureFolders, depth_of_another_size_is_scaled_and_so_is_a_calibration) {
  const DataFolder folder;
  folder.color("rgb/0.png", 128, 96);
  folder.depth("depth/0.png", 2000, 64, 48);
  const auto source = make_source(folder.uri("?intrinsics=208,212,127.5,95.5,256,192"));
  EXPECT_THAT(notes_of(*source),
              AllOf(HasSubstr("its images have 128 x 96 px"), HasSubstr("depth of 64 x 48 px is scaled")));
  EXPECT_DOUBLE_EQ(source->info().camera.parameters().fx, 104);
  EXPECT_DOUBLE_EQ(source->info().camera.parameters().cx, 63.5);
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  EXPECT_NEAR(metres(*frame, 50, 50), 2, 1e-3);
  EXPECT_GT(cv::countNonZero(frame->image.depth), 128 * 96 * 9 / 10);
}

TEST(CaptureFolders, floats_are_metres_or_millimetres_by_their_size) {
  for (const auto& [value, metres_there] : {std::pair(1.5, 1.5), std::pair(1500.0, 1.5), std::pair(30.0, 30.0)}) {
    const DataFolder folder;
    folder.color("rgb/0.png");
    folder.image("depth/0.tiff", cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(value)));
    EXPECT_NEAR(metres(test::play(folder.uri(kIntrinsics)).at(0)), metres_there, 1e-3) << value;
  }
}

TEST(CaptureFolders, units_that_no_file_gives_are_seen_by_the_images) {
  const DataFolder folder;
  folder.color("rgb/0.png");
  folder.depth("depth/0.png", 20003);
  EXPECT_NEAR(metres(test::play(folder.uri(kIntrinsics)).at(0)), 4.0006, 1e-6) << "20 m is too far for a depth camera";
}

TEST(CaptureFolders, one_sequence_below_is_taken_and_several_are_listed) {
  const DataFolder folder;
  for (const char* const file : {"data/seq-01/rgb/0.png", "data/seq-01/rgb/1.png"}) folder.color(file);
  folder.depth("data/seq-01/depth/0.png");
  EXPECT_THAT(test::play(folder.uri(kIntrinsics)), SizeIs(1));
  folder.color("data/seq-02/rgb/0.png");
  folder.depth("data/seq-02/depth/0.png");
  EXPECT_TRUE(test::refuses(folder.uri(), {"holds 2 sequences", "data/seq-02"}));
}

TEST(CaptureFolders, says_what_to_do_without_a_calibration_or_a_layout) {
  const DataFolder folder;
  EXPECT_TRUE(test::refuses(folder.uri(), {"7-Scenes", "rgb.txt", "depth/"}));
  folder.color("rgb/0.png");
  folder.depth("depth/0.png");
  EXPECT_TRUE(test::refuses(folder.uri(), {"?intrinsics=fx,fy,cx,cy", "?calibration=FILE"}));
}

TEST(CaptureFolders, archives_and_forms_without_a_reader_get_a_sentence) {
  for (const auto& [name, advice] :
       {std::pair("x.tgz", "tar xf"), std::pair("a.tar.gz", "tar xf"), std::pair("x.ZIP", "unzip"),
        std::pair("x.7z", "7z x"), std::pair("k4a.mkv", "azure_kinect_mkv_reader.py"),
        std::pair("x.klg", "ElasticFusion"), std::pair("s.sens", "--export_color_images"),
        std::pair("z.svo2", "ros2 bag record"), std::pair("i.r3d", "Record3D"),
        std::pair("map.db", "rtabmap-databaseViewer"), std::pair("v.mp4", "without depth")}) {
    const DataFolder folder;
    folder.write(name, "x");
    const std::string path = (folder.path() / name).string();
    const auto open = [&] { make_source(complete_uri(path)); };
    EXPECT_THAT(open, ThrowsMessage<SourceError>(AllOf(HasSubstr(name), HasSubstr(advice))));
    EXPECT_TRUE(test::refuses(folder.uri(), {advice})) << "a folder of it";
  }
  EXPECT_EQ(advice_for_file("x.bag"), "");
}

TEST(CaptureFolders, tum_times_in_names_pair_without_lists) {
  const DataFolder folder;
  for (const char* const stamp : {"1305031102.175304", "1305031102.211214", "1305031102.275326"})
    folder.color(std::string("rgb/") + stamp + ".png");
  folder.depth("depth/1305031102.160407.png");
  folder.depth("depth/1305031102.262886.png");
  folder.write("groundtruth.txt", "1305031102.1758 1 2 3 0 0 0 1\n");
  const auto played = test::play_all(folder.uri(kIntrinsics));
  ASSERT_THAT(played.frames, SizeIs(2));
  EXPECT_EQ(played.frames[0].image.stamp_ns, 1305031102175304000);
  EXPECT_EQ(played.counters.of(SkipReason::kNoDepthPartner), 1U);
  EXPECT_THAT(make_source(folder.uri(kIntrinsics))->groundtruth(), SizeIs(1));
}

/// Inputs of other people, each with what is right.
class FieldData : public ::testing::Test {
 protected:
  FieldData() {
    if (const char* const data = std::getenv("RTD_DATA_DIR")) field_ = fs::path(data) / "field";
  }
  void SetUp() override {
    if (field_.empty() || !fs::is_directory(field_)) GTEST_SKIP() << "set RTD_DATA_DIR";
  }
  std::string at(const std::string& name) const { return complete_uri((field_ / name).string()); }

  fs::path field_;
};

TEST_F(FieldData, a_numbered_folder_plays) {
  const auto frames = test::play(at("numbered_folder"));
  EXPECT_THAT(frames, SizeIs(4));
  EXPECT_EQ(frames.at(0).image.camera.parameters().fx, 78.75);
  EXPECT_EQ(frames.at(0).image.depth_scale_m, 0.001);
}

TEST_F(FieldData, settings_of_orb_slam_give_the_camera) {
  for (const char* const file : {"orb2.yaml", "orb3.yaml"}) {
    const auto source = make_source(at("orb_slam_settings?calibration=" + std::string(file)));
    EXPECT_EQ(source->info().camera.parameters().fx, 78.75);
    EXPECT_EQ(source->info().depth_scale_m, 0.001);
    EXPECT_EQ(source->info().fps, 10);
    EXPECT_EQ(source->info().frames, 4U);
  }
}

TEST_F(FieldData, settings_beside_the_data_are_named_with_the_source_that_takes_them) {
  EXPECT_TRUE(test::refuses(at("orb_slam_settings"), {"orb2.yaml (ORB-SLAM2 settings), orb3.yaml (ORB-SLAM3 settings)",
                                                      "orb_slam_settings?calibration=orb2.yaml'"}));
}

TEST_F(FieldData, stamps_that_are_durations_need_a_rate) {
  EXPECT_TRUE(test::refuses(at("stamps_are_durations"), {"are not times"}));
  EXPECT_THAT(test::play(at("stamps_are_durations?fps=30")), SizeIs(8));
}

TEST_F(FieldData, groundtruth_with_a_title_and_nan_does_not_stop_the_frames) {
  const auto source = make_source(at("groundtruth_with_title_and_nan"));
  EXPECT_THAT(source->info().remarks,
              testing::ElementsAre(HasSubstr("title line without '#' left out"), HasSubstr("of nan left out")));
  EXPECT_FALSE(source->groundtruth().empty());
}

}  // namespace
}  // namespace rtd::camera::layouts
