// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>

#include "common/geometry/pose_list.hpp"
#include "services/slam/map_keeper.hpp"

namespace rtd::slam {
namespace {

using testing::SizeIs;

TEST(RunFiles, a_trajectory_whose_stamps_go_back_has_a_file_for_each_segment) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("rtd_run_files_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::vector<StampedPose> poses;
  for (const std::int64_t second : {1, 2, 3, 1, 2}) poses.push_back({second * 1'000'000'000, {}});
  for (StampedPose& pose : poses) pose.T_world_body.setIdentity();
  write_trajectory(poses, folder / "trajectory");
  EXPECT_THAT(geometry::read_pose_list(std::filesystem::path(folder / "trajectory.txt")).poses, SizeIs(3));
  EXPECT_THAT(geometry::read_pose_list(std::filesystem::path(folder / "trajectory_segment_2.txt")).poses, SizeIs(2));
  EXPECT_FALSE(std::filesystem::exists(folder / "trajectory_segment_3.txt"));
  write_trajectory({}, folder / "none");
  EXPECT_TRUE(std::filesystem::exists(folder / "none.txt")) << "empty, but there";
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace rtd::slam
