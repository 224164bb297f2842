// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/datasets/dataset.hpp"

#include <gmock/gmock.h>

#include "common/camera/calibration.hpp"
#include "common/camera/frame_source.hpp"
#include "common/geometry/pose_list.hpp"
#include "tests/unit/evaluation/datasets/dataset_folder.hpp"

namespace rtd::eval {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::DatasetFolder;

class PrepareOpenloris : public ::testing::Test {
 protected:
  void SetUp() override { data_.add_openloris("cafe1-1"); }
  void prepare() const { prepare_openloris(data_.path() / "cafe1-1", into_); }

  const DatasetFolder data_;
  const fs::path into_ = data_.path() / "out/cafe1-1";
};

TEST_F(PrepareOpenloris, reads_the_intrinsics_in_their_order_and_depth_in_millimetres) {
  prepare();
  const camera::Calibration calibration = camera::load_calibration(into_);
  const auto& parameters = calibration.camera.parameters();
  EXPECT_DOUBLE_EQ(parameters.fx, 611.45);
  EXPECT_DOUBLE_EQ(parameters.cx, 433.2);
  EXPECT_DOUBLE_EQ(parameters.fy, 611.49);
  EXPECT_DOUBLE_EQ(parameters.cy, 249.47);
  EXPECT_EQ(parameters.width, 848);
  EXPECT_DOUBLE_EQ(calibration.depth_scale_m, 0.001);
}

TEST_F(PrepareOpenloris, moves_the_ground_truth_from_the_base_to_the_camera) {
  prepare();
  const geometry::Trajectory truth = geometry::read_pose_list(std::filesystem::path(into_ / "groundtruth.txt")).poses;
  ASSERT_EQ(truth.size(), 2U);
  // T_base_camera = T_base_laser * T_camera_laser^-1: the camera is 0.3 m behind the base and 0.3 m above it.
  EXPECT_TRUE(truth[0].T_world_body.translation().isApprox(Eigen::Vector3d(0.7, 0, 0.3), 1e-6));
  EXPECT_TRUE(truth[1].T_world_body.translation().isApprox(Eigen::Vector3d(2.3, 0, 0.3), 1e-6)) << "turned by 180 deg";
}

TEST_F(PrepareOpenloris, makes_a_folder_whose_images_are_there_and_can_be_made_again) {
  prepare();
  prepare();
  EXPECT_TRUE(fs::exists(into_ / "color/1.png"));
  EXPECT_TRUE(fs::exists(into_ / "aligned_depth/2.png"));
  EXPECT_THAT(rtd::test::read_text(into_ / "rgb.txt"), HasSubstr("1.0 color/1.png"));
}

TEST_F(PrepareOpenloris, frames_that_are_all_linked_to_each_other_take_no_longer) {
  const std::string matrix =
      "      matrix: !!opencv-matrix\n         rows: 4\n         cols: 4\n         dt: d\n"
      "         data: [ 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1. ]\n";
  const auto name = [](int frame) { return frame == 0 ? "base_link" : "f" + std::to_string(frame); };
  std::string links = "%YAML:1.0\ntrans_matrix:\n";
  for (int i = 0; i < 400; ++i)
    links += "   -\n      parent_frame: " + name(i / 20) + "\n      child_frame: " + name(i % 20) + "\n" + matrix;
  data_.write("cafe1-1/trans_matrix.yaml", links);
  EXPECT_THAT([&] { prepare(); }, testing::ThrowsMessage<camera::SourceError>(HasSubstr("no transforms lead")));
}

TEST_F(PrepareOpenloris, names_the_file_that_it_cannot_use) {
  data_.write("cafe1-1/sensors.yaml", "%YAML:1.0\nother: 1\n");
  EXPECT_THAT([&] { prepare(); }, testing::ThrowsMessage<camera::SourceError>(HasSubstr("sensors.yaml")));
  data_.add_openloris("cafe1-1");
  data_.write("cafe1-1/groundtruth.txt", "frame: gt_map gripper\n1.0 0 0 0 0 0 0 1\n");
  EXPECT_THAT([&] { prepare(); },
              testing::ThrowsMessage<camera::SourceError>(HasSubstr("no transforms lead from gripper")));
}

}  // namespace
}  // namespace rtd::eval
