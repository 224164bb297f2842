// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/evaluation_clip.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "common/camera/calibration.hpp"
#include "common/geometry/pose_list.hpp"
#include "tests/support/tum_lists.hpp"

namespace rtd::test_support {
namespace {

geometry::Trajectory read_poses(const std::string& path) {
  if (!std::filesystem::exists(path)) return {};
  return geometry::read_pose_list(std::filesystem::path(path)).poses;
}

Eigen::Isometry3d nearest_pose(const geometry::Trajectory& poses, std::int64_t stamp_ns) {
  constexpr std::int64_t kToleranceNs = 20'000'000;
  Eigen::Isometry3d nearest = Eigen::Isometry3d::Identity();
  std::int64_t distance_ns = kToleranceNs;
  auto pose = std::ranges::lower_bound(poses, stamp_ns - kToleranceNs, {}, &geometry::StampedPose::stamp_ns);
  for (; pose != poses.end() && pose->stamp_ns <= stamp_ns + kToleranceNs; ++pose) {
    if (std::abs(pose->stamp_ns - stamp_ns) > distance_ns) continue;
    distance_ns = std::abs(pose->stamp_ns - stamp_ns);
    nearest = pose->T_world_body;
  }
  return nearest;
}

}  // namespace

std::optional<EvaluationClip> EvaluationClip::find(const std::string& name) {
  const char* root = std::getenv("RTD_DATA_DIR");
  if (root == nullptr || !std::filesystem::exists(std::filesystem::path(root) / name)) return std::nullopt;
  return EvaluationClip((std::filesystem::path(root) / name).string());
}

EvaluationClip::EvaluationClip(const std::string& directory) : camera_(camera::load_calibration(directory).camera) {
  const geometry::Trajectory poses = read_poses(directory + "/groundtruth.txt");
  std::optional<Eigen::Isometry3d> T_camera0_world;
  for (const auto& [color, depth] : read_tum_lists(directory).pairs) {
    const Eigen::Isometry3d T = nearest_pose(poses, color.stamp_ns);
    if (!T_camera0_world) T_camera0_world = T.inverse();
    const std::string mask = directory + "/mask/" + std::filesystem::path(color.file).stem().string() + ".png";
    frames_.push_back(
        {color.stamp_ns, directory + "/" + color.file, directory + "/" + depth.file, mask, *T_camera0_world * T});
  }
}

vision::RgbdImage EvaluationClip::image(std::size_t index) const {
  const Frame& frame = frames_.at(index);
  constexpr double kTumDepthScaleM = 1.0 / 5000.0;
  return {
      index,           frame.stamp_ns, cv::imread(frame.color_path), cv::imread(frame.depth_path, cv::IMREAD_UNCHANGED),
      kTumDepthScaleM, camera_};
}

cv::Mat EvaluationClip::dynamic_mask(std::size_t index) const {
  if (!std::filesystem::exists(frames_.at(index).mask_path)) return {};
  const cv::Mat mask = cv::imread(frames_.at(index).mask_path, cv::IMREAD_GRAYSCALE);
  return mask.empty() ? mask : cv::Mat(mask > 0);
}

}  // namespace rtd::test_support
