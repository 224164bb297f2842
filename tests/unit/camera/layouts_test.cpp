// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Datasets and capture scripts rebuilt small: names of files and forms of texts are theirs.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <bit>
#include <cstdlib>

#include "common/camera/folder/folder_source.hpp"
#include "common/camera/unread_forms.hpp"
#include "tests/unit/camera/played_frames.hpp"
#include "tests/unit/camera/sequence_folder.hpp"

namespace rtd::camera {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

constexpr int kWidth = 64, kHeight = 48;
constexpr const char* kIntrinsics = "?intrinsics=52,53,31.5,23.5";

/// A folder below a temporary one, removed with the object.
class DataFolder {
 public:
  explicit DataFolder(const std::string& name = "kitchen") {
    static int count = 0;
    root_ = fs::temp_directory_path() / ("rtd_layouts_" + std::to_string(getpid()) + "_" + std::to_string(count++));
    path_ = root_ / name;
    fs::create_directories(path_);
  }
  ~DataFolder() { fs::remove_all(root_); }
  DataFolder(const DataFolder&) = delete;
  DataFolder& operator=(const DataFolder&) = delete;

  const fs::path& path() const { return path_; }
  std::string uri(const std::string& parameters = "") const { return "folder:" + path_.string() + parameters; }
  void write(const std::string& file, const std::string& text) const {
    fs::create_directories((path_ / file).parent_path());
    std::ofstream(path_ / file, std::ios::binary) << text;
  }
  void color(const std::string& file, int width = kWidth, int height = kHeight) const {
    image(file, cv::Mat(height, width, CV_8UC3, cv::Scalar(40, 80, 120)));
  }
  void depth(const std::string& file, int units = 2000, int width = kWidth, int height = kHeight) const {
    image(file, cv::Mat(height, width, CV_16UC1, cv::Scalar(units)));
  }
  void image(const std::string& file, const cv::Mat& pixels) const {
    fs::create_directories((path_ / file).parent_path());
    ASSERT_TRUE(cv::imwrite((path_ / file).string(), pixels));
  }
  void npy(const std::string& file, const cv::Mat& values, const std::string& type, const std::string& shape) const {
    std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }";
    header.resize(118 - 1, ' ');
    header += '\n';
    const std::string start("\x93NUMPY\x01\x00\x76\x00", 10);
    write(file,
          start + header + std::string(reinterpret_cast<const char*>(values.data), values.total() * values.elemSize()));
  }

 private:
  fs::path root_, path_;
};

/// Metres at a pixel.
double metres(const SourceFrame& frame, int row = 10, int column = 10) {
  return frame.image.depth.at<std::uint16_t>(row, column) * frame.image.depth_scale_m;
}

std::string number(int i, int digits) {
  std::string text = std::to_string(i);
  return std::string(static_cast<std::size_t>(digits) - text.size(), '0') + text;
}

std::string notes_of(const FrameSource& source) {
  std::string notes;
  for (const std::string& note : source.info().notes) notes += note + "\n";
  return notes;
}

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

TEST(Layouts, tum_times_in_names_pair_without_lists) {
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

TEST(Layouts, names_of_capture_scripts_pair) {
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

TEST(Layouts, numbers_without_leading_zeros_are_in_the_order_of_numbers) {
  const DataFolder folder;
  for (int i = 1; i <= 12; ++i) {
    folder.color("rgb/" + std::to_string(i) + ".png");
    folder.depth("depth/" + std::to_string(i - 1) + ".png", 1000 + i);
  }
  const auto frames = test::play(folder.uri(kIntrinsics));
  ASSERT_THAT(frames, SizeIs(12));
  for (int i = 0; i < 12; ++i) EXPECT_NEAR(metres(frames[static_cast<std::size_t>(i)]), 1.001 + 0.001 * i, 1e-9);
}

TEST(Layouts, calibration_file_gives_camera_rate_and_unit_of_a_tum_folder) {
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
  EXPECT_THAT([&] { make_source(folder.uri("?calibration=none.yaml")); },
              ThrowsMessage<SourceError>(HasSubstr("none.yaml cannot be read")));
}

TEST(Layouts, stamps_that_are_no_times_are_an_error_and_a_rate_replaces_them) {
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
  EXPECT_THAT([&] { make_source(folder.uri(kIntrinsics)); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("4 of 8"), HasSubstr("?fps=30"))));
  const auto frames = test::play(folder.uri(std::string(kIntrinsics) + "&fps=30"));
  ASSERT_THAT(frames, SizeIs(8));
  EXPECT_EQ(frames[7].image.stamp_ns, 233'333'333);
}

TEST(Layouts, depth_of_another_size_is_scaled_and_so_is_a_calibration) {
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

TEST(Layouts, floats_are_metres_or_millimetres_by_their_size) {
  for (const auto& [value, metres_there] : {std::pair(1.5, 1.5), std::pair(1500.0, 1.5), std::pair(30.0, 30.0)}) {
    const DataFolder folder;
    folder.color("rgb/0.png");
    folder.image("depth/0.tiff", cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(value)));
    EXPECT_NEAR(metres(test::play(folder.uri(kIntrinsics)).at(0)), metres_there, 1e-3) << value;
  }
}

TEST(Layouts, units_that_no_file_gives_are_seen_by_the_images) {
  const DataFolder folder;
  folder.color("rgb/0.png");
  folder.depth("depth/0.png", 20003);
  EXPECT_NEAR(metres(test::play(folder.uri(kIntrinsics)).at(0)), 4.0006, 1e-6) << "20 m is too far for a depth camera";
}

TEST(Layouts, one_sequence_below_is_taken_and_several_are_listed) {
  const DataFolder folder;
  for (const char* const file : {"data/seq-01/rgb/0.png", "data/seq-01/rgb/1.png"}) folder.color(file);
  folder.depth("data/seq-01/depth/0.png");
  EXPECT_THAT(test::play(folder.uri(kIntrinsics)), SizeIs(1));
  folder.color("data/seq-02/rgb/0.png");
  folder.depth("data/seq-02/depth/0.png");
  EXPECT_THAT([&] { make_source(folder.uri()); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("holds 2 sequences"), HasSubstr("data/seq-02"))));
}

TEST(Layouts, says_what_to_do_without_a_calibration_or_a_layout) {
  const DataFolder folder;
  EXPECT_THAT([&] { make_source(folder.uri()); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("7-Scenes"), HasSubstr("rgb.txt"), HasSubstr("depth/"))));
  folder.color("rgb/0.png");
  folder.depth("depth/0.png");
  EXPECT_THAT([&] { make_source(folder.uri()); },
              ThrowsMessage<SourceError>(AllOf(HasSubstr("?intrinsics=fx,fy,cx,cy"), HasSubstr("?calibration=FILE"))));
}

TEST(Layouts, archives_and_forms_without_a_reader_get_a_sentence) {
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
    EXPECT_THAT([&] { make_source(folder.uri()); }, ThrowsMessage<SourceError>(HasSubstr(advice))) << "a folder of it";
  }
  EXPECT_EQ(advice_for_file("x.bag"), "");
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
  EXPECT_THAT(
      [&] { make_source(at("orb_slam_settings")); },
      ThrowsMessage<SourceError>(AllOf(HasSubstr("orb2.yaml (ORB-SLAM2 settings), orb3.yaml (ORB-SLAM3 settings)"),
                                       HasSubstr("orb_slam_settings?calibration=orb2.yaml'"))));
}

TEST_F(FieldData, stamps_that_are_durations_need_a_rate) {
  EXPECT_THAT([&] { make_source(at("stamps_are_durations")); }, ThrowsMessage<SourceError>(HasSubstr("are not times")));
  EXPECT_THAT(test::play(at("stamps_are_durations?fps=30")), SizeIs(8));
}

TEST_F(FieldData, groundtruth_with_a_title_and_nan_does_not_stop_the_frames) {
  const auto source = make_source(at("groundtruth_with_title_and_nan"));
  EXPECT_THAT(source->info().remarks,
              testing::ElementsAre(HasSubstr("title line without '#' left out"), HasSubstr("of nan left out")));
  EXPECT_FALSE(source->groundtruth().empty());
}

}  // namespace
}  // namespace rtd::camera
