// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Datasets and capture scripts rebuilt small: names of files and forms of texts are theirs.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <bit>

#include "common/camera/folder/folder_source.hpp"
#include "tests/unit/camera/data_folder.hpp"
#include "tests/unit/camera/played_frames.hpp"

namespace rtd::camera::layouts {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr const char* kPose4x4 = "1 0 0 0.5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

TEST(Layouts, open3d_numbers_pairs_and_has_its_intrinsics_by_columns) {
  const DataFolder folder;
  for (int i = 0; i < 4; ++i) {
    folder.color("color/" + number(i, 5) + ".jpg");
    folder.depth("depth/" + number(i, 5) + ".png");
  }
  folder.write("camera_intrinsic.json",
               R"({"width": 64, "height": 48, "intrinsic_matrix": [52, 0, 0, 0, 53, 0, 31.5, 23.5, 1]})");
  const auto source = make_source(folder.uri());
  EXPECT_THAT(notes_of(*source), AllOf(HasSubstr("for Open3D: 4 pairs by the numbers in their names"),
                                       HasSubstr("fx 52 fy 53 cx 31.5 cy 23.5 at 64 x 48 px"),
                                       HasSubstr("camera_intrinsic.json (Open3D intrinsics)"),
                                       HasSubstr("1000 units per metre by the layout"), HasSubstr("?fps=")));
  const auto frames = test::play(folder.uri("?fps=10"));
  ASSERT_THAT(frames, SizeIs(4));
  EXPECT_EQ(frames[3].image.stamp_ns, 300'000'000);
  EXPECT_NEAR(metres(frames[0]), 2, 1e-9);
}

TEST(Layouts, redwood_has_microseconds_in_its_names_and_a_log_of_poses) {
  const DataFolder folder;
  for (int i = 0; i < 3; ++i) {
    folder.color("rgb/" + number(i + 1, 7) + "-" + number(33369 * i, 12) + ".jpg", 640, 480);
    folder.depth("depth/" + number(i + 1, 7) + "-" + number(33369 * i, 12) + ".png", 2000, 640, 480);
  }
  folder.write("trajectory.log", std::string("0\t0\t1\n") + kPose4x4 + "1 1 2\n" + kPose4x4 + "2 2 3\n" + kPose4x4);
  const auto source = make_source(folder.uri());
  EXPECT_THAT(notes_of(*source), AllOf(HasSubstr("for Redwood: 3 pairs by the times"), HasSubstr("fx 525")));
  EXPECT_THAT(source->groundtruth(), SizeIs(3));
  const auto frames = test::play(folder.uri());
  ASSERT_THAT(frames, SizeIs(3));
  EXPECT_EQ(frames[2].image.stamp_ns, 66'738'000);
}

TEST(Layouts, sun3d_has_redwoods_names_and_rotated_depth) {
  const DataFolder folder("sun3d/hotel");
  cv::Mat depth_mm(480, 640, CV_16UC1);
  cv::randu(depth_mm, 600, 8600);
  cv::Mat stored(depth_mm.size(), CV_16UC1);
  std::transform(depth_mm.begin<std::uint16_t>(), depth_mm.end<std::uint16_t>(), stored.begin<std::uint16_t>(),
                 [](std::uint16_t mm) { return std::rotl(mm, 3); });
  for (int i = 0; i < 3; ++i) {
    const std::string name = number(i + 1, 7) + "-" + number(33369 * i, 12);
    folder.color("image/" + name + ".jpg", 640, 480);
    folder.image("depth/" + name + ".png", stored);
  }
  const auto source = make_source(folder.uri());
  EXPECT_THAT(notes_of(*source), HasSubstr("rotated by three bits as SUN3D"));
  const auto frames = test::play(folder.uri());
  ASSERT_THAT(frames, SizeIs(3));
  EXPECT_DOUBLE_EQ(frames[0].image.depth_scale_m, 0.001);
  EXPECT_EQ(cv::countNonZero(frames[0].image.depth != depth_mm), 0) << "also beyond 8.191 m";
}

TEST(Layouts, seven_scenes_has_a_pose_for_each_frame) {
  const DataFolder folder("chess/seq-01");
  for (int i = 0; i < 3; ++i) {
    folder.color("frame-" + number(i, 6) + ".color.png", 640, 480);
    folder.depth("frame-" + number(i, 6) + ".depth.png", i == 0 ? 65535 : 2000, 640, 480);
    folder.write("frame-" + number(i, 6) + ".pose.txt", "  1.0000000e+00\t 0.0000000e+00\t 0.0000000e+00\t " +
                                                            std::to_string(i) + "\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  }
  const auto source = make_source(folder.uri());
  EXPECT_THAT(notes_of(*source), AllOf(HasSubstr("for 7-Scenes"), HasSubstr("fx 585"), HasSubstr("3 matrices")));
  ASSERT_THAT(source->groundtruth(), SizeIs(3));
  EXPECT_EQ(source->groundtruth()[2].T_world_body.translation().x(), 2);
  EXPECT_EQ(source->groundtruth()[2].stamp_ns, 66'666'667);
  const auto frames = test::play(folder.uri());
  EXPECT_FALSE(frames.at(0).has_depth) << "65535 is no measurement";
  EXPECT_NEAR(metres(frames.at(1)), 2, 1e-9);
}

TEST(Layouts, openloris_has_lists_of_its_own_and_sensors_yaml) {
  const DataFolder folder;
  std::string color = "#color images\n#timestamp filename\n", depth = "#aligned depth images\n";
  for (int i = 0; i < 3; ++i) {
    const std::string stamp = "1560000053." + number(100000 + 33000 * i, 6);
    folder.color("color/" + stamp + ".png");
    folder.depth("aligned_depth/" + stamp + ".png", 1500);
    color += stamp + " color/" + stamp + ".png\n";
    depth += stamp + " aligned_depth/" + stamp + ".png\n";
  }
  folder.write("color.txt", color);
  folder.write("aligned_depth.txt", depth);
  folder.write("sensors.yaml",
               "%YAML:1.0\nd400_color_optical_frame:\n   width: 64\n   height: 48\n   fps: 30\n"
               "   intrinsics: !!opencv-matrix\n      rows: 1\n      cols: 4\n      dt: d\n"
               "      data: [ 52., 31.5, 53., 23.5 ]\n");
  const auto source = make_source(folder.uri());
  EXPECT_THAT(notes_of(*source), AllOf(HasSubstr("for OpenLORIS"), HasSubstr("fx 52 fy 53 cx 31.5 cy 23.5")));
  const auto frames = test::play(folder.uri());
  ASSERT_THAT(frames, SizeIs(3));
  EXPECT_NEAR(metres(frames[0]), 1.5, 1e-9);
}

TEST(Layouts, eth3d_has_four_numbers_for_its_camera) {
  const DataFolder folder("cables_1");
  folder.color("rgb/4231.372290.png");
  folder.color("rgb/4231.409235.png");
  folder.depth("depth/4231.372290.png", 10000);
  folder.depth("depth/4231.409235.png", 10000);
  folder.write("associated.txt",
               "4231.372290 rgb/4231.372290.png 4231.372290 depth/4231.372290.png\n"
               "4231.409235 rgb/4231.409235.png 4231.409235 depth/4231.409235.png\n");
  folder.write("rgb.txt", "4231.372290 rgb/4231.372290.png\n");
  folder.write("depth.txt", "4231.372290 depth/4231.372290.png\n");
  folder.write("calibration.txt", "52.5 53.5 31.25 23.25\n");
  folder.write("groundtruth.txt",
               "# timestamp tx ty tz qx qy qz qw\n4231.372290 0 0 0 0 0 0 1\n4231.409235 1 0 0 0 0 0 1\n");
  const auto source = make_source(folder.uri());
  EXPECT_THAT(notes_of(*source),
              AllOf(HasSubstr("for ETH3D: 2 pairs by associated.txt"), HasSubstr("fx 52.5 fy 53.5")));
  EXPECT_THAT(source->groundtruth(), SizeIs(2));
  EXPECT_NEAR(metres(test::play(folder.uri()).at(0)), 2, 1e-9);
}

TEST(Layouts, tartanair_has_floats_in_npy_and_poses_in_ned_axes) {
  const DataFolder folder("P001");
  for (int i = 0; i < 3; ++i) {
    folder.color("image_left/" + number(i, 6) + "_left.png", 640, 480);
    folder.npy("depth_left/" + number(i, 6) + "_left_depth.npy", cv::Mat(480, 640, CV_32FC1, cv::Scalar(3.5)), "<f4",
               "(480, 640)");
  }
  folder.write("pose_left.txt", "0 0 0 0 0 0 1\n1 2 3 0 0 0 1\n2 4 6 0 0 0 1\n");
  const auto source = make_source(folder.uri());
  EXPECT_THAT(notes_of(*source), AllOf(HasSubstr("for TartanAir"), HasSubstr("fx 320"), HasSubstr("floats in metres")));
  const geometry::Trajectory truth = source->groundtruth();
  ASSERT_THAT(truth, SizeIs(3));
  const Eigen::Vector3d forward = truth[0].T_world_body.linear() * Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(forward.isApprox(Eigen::Vector3d::UnitX())) << forward.transpose();
  EXPECT_NEAR(metres(test::play(folder.uri()).at(0)), 3.5, 1e-3);
}

TEST(Layouts, icl_nuim_counts_frames_names_depth_first_and_has_y_up) {
  const DataFolder folder("living_room_traj2_frei_png");
  std::string pairs;
  for (int i = 0; i < 5; ++i) {
    folder.color("rgb/" + std::to_string(i) + ".png", 640, 480);
    folder.depth("depth/" + std::to_string(i) + ".png", 10000, 640, 480);
    pairs += std::to_string(i) + " depth/" + std::to_string(i) + ".png " + std::to_string(i) + " rgb/" +
             std::to_string(i) + ".png\n";
  }
  folder.write("associations.txt", pairs);
  folder.write("livingRoom2.gt.freiburg",
               "0 0 0 0 0 0 0 1\n1 1 2 3 0.1 0 0 0.994987437\n2 1 2 3 0 0 0 1\n3 0 0 0 0 0 0 1\n");
  const auto source = make_source(folder.uri());
  EXPECT_THAT(notes_of(*source), AllOf(HasSubstr("for ICL-NUIM"), HasSubstr("fy 480"), HasSubstr("y axis"),
                                       HasSubstr("30 frames per second")));
  const geometry::Trajectory truth = source->groundtruth();
  ASSERT_THAT(truth, SizeIs(4));
  EXPECT_EQ(truth[1].stamp_ns, 33'333'333);
  EXPECT_TRUE(truth[1].T_world_body.translation().isApprox(Eigen::Vector3d(1, -2, 3)));
  const Eigen::Quaterniond q(truth[1].T_world_body.linear());
  EXPECT_NEAR(q.x(), -0.1, 1e-6);
  EXPECT_NEAR(metres(test::play(folder.uri()).at(0)), 2, 1e-9);
}

TEST(Layouts, scannet_depth_of_another_lens_and_size_is_registered) {
  const DataFolder folder("scene0000_00");
  for (int i = 0; i < 60; i += 20) {
    folder.color("color/" + std::to_string(i) + ".jpg", 128, 96);
    folder.depth("depth/" + std::to_string(i) + ".png", 2000, 64, 48);
    folder.write("pose/" + std::to_string(i) + ".txt", i == 20 ? "-inf -inf -inf -inf\n-inf -inf -inf -inf\n"
                                                                 "-inf -inf -inf -inf\n0 0 0 1\n"
                                                               : kPose4x4);
  }
  folder.write("intrinsic/intrinsic_color.txt", "115 0 63.5 0\n0 115 47.5 0\n0 0 1 0\n0 0 0 1\n");
  folder.write("intrinsic/intrinsic_depth.txt", "56 0 31.5 0\n0 56 23.5 0\n0 0 1 0\n0 0 0 1\n");
  const auto source = make_source(folder.uri());
  EXPECT_THAT(notes_of(*source), AllOf(HasSubstr("for ScanNet export"), HasSubstr("fx 115"), HasSubstr("registered"),
                                       HasSubstr("1 left out that are no poses")));
  EXPECT_THAT(source->groundtruth(), SizeIs(2));
  const auto frames = test::play(folder.uri());
  ASSERT_THAT(frames, SizeIs(3));
  EXPECT_EQ(frames[0].image.depth.size(), cv::Size(128, 96));
  EXPECT_NEAR(metres(frames[0], 48, 64), 2, 1e-3);
  EXPECT_EQ(frames[1].image.stamp_ns, 666'666'667) << "every twentieth frame was exported";
}

TEST(Layouts, replica_has_a_factor_and_a_table_of_matrices_in_rows) {
  const DataFolder folder("room0");
  for (int i = 0; i < 2; ++i) {
    folder.color("results/frame" + number(i, 6) + ".jpg");
    folder.depth("results/depth" + number(i, 6) + ".png", 13107);
  }
  folder.write("traj.txt", "1 0 0 0.1 0 1 0 0 0 0 1 0 0 0 0 1\n1 0 0 0.2 0 1 0 0 0 0 1 0 0 0 0 1\n");
  std::ofstream(folder.path() / "../cam_params.json")
      << R"({"camera": {"w": 64, "h": 48, "fx": 52.0, "fy": 53.0, "cx": 31.5, "cy": 23.5, "scale": 6553.5}})";
  const auto source = make_source(folder.uri());
  EXPECT_THAT(notes_of(*source), AllOf(HasSubstr("for Replica"), HasSubstr("6553.5 units per metre")));
  EXPECT_THAT(source->groundtruth(), SizeIs(2));
  EXPECT_NEAR(metres(test::play(folder.uri()).at(0)), 2, 1e-9);
}

/// The matrix is that of the app's 1920 x 1440 px, however ffmpeg scaled the images.
TEST(Layouts, stray_scanners_frames_have_times_and_are_scaled_with_their_camera) {
  for (const int width : {1920, 960, 640}) {
    const DataFolder folder;
    std::string table = "timestamp, frame, x, y, z, qx, qy, qz, qw\n";
    for (int i = 0; i < 3; ++i) {
      folder.color("rgb/" + number(i, 6) + ".png", width, width * 3 / 4);
      folder.depth("depth/" + number(i, 6) + ".png", 2000, 256, 192);
      table += fmt::format("{}.5, {}, 0, 0, 0, 0, 0, 0, 1\n", 1000 + i * i, number(i, 6));
    }
    folder.write("camera_matrix.csv", "1572.0, 0.0, 957.0\n0.0, 1572.0, 717.0\n0.0, 0.0, 1.0\n");
    folder.write("odometry.csv", table);
    const auto source = make_source(folder.uri());
    EXPECT_THAT(notes_of(*source), AllOf(HasSubstr("for Stray Scanner: 3 pairs by the numbers in their names, at the "
                                                   "times of odometry.csv"),
                                         HasSubstr(width > 1000 ? "more than a frame carries" : "its images have")));
    const auto frames = test::play(folder.uri());
    ASSERT_THAT(frames, SizeIs(3));
    EXPECT_EQ(frames[2].image.stamp_ns, 1'004'500'000'000);
    EXPECT_EQ(frames[2].image.color_bgr.cols, width > 1000 ? 960 : width);
    const auto& camera = frames[2].image.camera.parameters();
    EXPECT_DOUBLE_EQ(camera.fx / camera.width, 1572.0 / 1920);
    EXPECT_DOUBLE_EQ((camera.cx + 0.5) / camera.width, 957.5 / 1920);
    EXPECT_NEAR(metres(frames[2], 50, 50), 2, 1e-3);
  }
}

}  // namespace
}  // namespace rtd::camera::layouts
