// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/evaluation_clip.hpp"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>

namespace rtd::test_support {
namespace {

std::int64_t stamp_ns(const std::string& seconds) {
  const std::size_t point = seconds.find('.');
  std::string fraction = point == std::string::npos ? "" : seconds.substr(point + 1);
  fraction.resize(9, '0');
  return std::stoll(seconds.substr(0, point)) * 1'000'000'000 + std::stoll(fraction);
}

geometry::CameraModel read_camera(const std::string& path) {
  const YAML::Node yaml = YAML::LoadFile(path);
  geometry::CameraModel::Parameters p;
  p.fx = yaml["fx"].as<double>();
  p.fy = yaml["fy"].as<double>();
  p.cx = yaml["cx"].as<double>();
  p.cy = yaml["cy"].as<double>();
  p.width = yaml["width"].as<int>();
  p.height = yaml["height"].as<int>();
  const char* names[] = {"k1", "k2", "p1", "p2", "k3"};
  for (std::size_t i = 0; i < p.distortion.size(); ++i) p.distortion[i] = yaml[names[i]].as<double>(0.0);
  return geometry::CameraModel(p);
}

std::map<std::int64_t, Eigen::Isometry3d> read_poses(const std::string& path) {
  std::map<std::int64_t, Eigen::Isometry3d> poses;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    std::string stamp;
    double tx, ty, tz, qx, qy, qz, qw;
    if (line.empty() || line[0] == '#' || !(fields >> stamp >> tx >> ty >> tz >> qx >> qy >> qz >> qw)) continue;
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    T_world_camera.linear() = Eigen::Quaterniond(qw, qx, qy, qz).normalized().toRotationMatrix();
    T_world_camera.translation() = Eigen::Vector3d(tx, ty, tz);
    poses[stamp_ns(stamp)] = T_world_camera;
  }
  return poses;
}

Eigen::Isometry3d nearest_pose(const std::map<std::int64_t, Eigen::Isometry3d>& poses, std::int64_t stamp) {
  constexpr std::int64_t kToleranceNs = 20'000'000;
  Eigen::Isometry3d nearest = Eigen::Isometry3d::Identity();
  std::int64_t distance = kToleranceNs;
  for (auto it = poses.lower_bound(stamp - kToleranceNs); it != poses.end() && it->first <= stamp + kToleranceNs;
       ++it) {
    if (std::abs(it->first - stamp) > distance) continue;
    distance = std::abs(it->first - stamp);
    nearest = it->second;
  }
  return nearest;
}

}  // namespace

std::optional<EvaluationClip> EvaluationClip::find(const std::string& name) {
  const char* root = std::getenv("RTD_DATA_DIR");
  if (root == nullptr || !std::filesystem::exists(std::filesystem::path(root) / name)) return std::nullopt;
  return EvaluationClip((std::filesystem::path(root) / name).string());
}

EvaluationClip::EvaluationClip(const std::string& directory) : camera_(read_camera(directory + "/calibration.yaml")) {
  const auto poses = read_poses(directory + "/groundtruth.txt");
  std::ifstream file(directory + "/associations.txt");
  if (!file) throw std::runtime_error(directory + "/associations.txt cannot be read");
  std::optional<Eigen::Isometry3d> T_camera0_world;
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    std::string color_stamp, color, depth_stamp, depth;
    if (!(fields >> color_stamp >> color >> depth_stamp >> depth)) continue;
    const Eigen::Isometry3d T = nearest_pose(poses, stamp_ns(color_stamp));
    if (!T_camera0_world) T_camera0_world = T.inverse();
    const std::string mask = directory + "/mask/" + std::filesystem::path(color).stem().string() + ".png";
    frames_.push_back(
        {stamp_ns(color_stamp), directory + "/" + color, directory + "/" + depth, mask, *T_camera0_world * T});
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
