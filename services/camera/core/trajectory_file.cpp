// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/core/trajectory_file.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "services/camera/core/text_fields.hpp"

namespace rtd::camera {
namespace {

constexpr std::size_t kValues = 7;  // tx ty tz qx qy qz qw

StampedPose parse_pose(const TextLine& line, const std::string& where) {
  const auto fail = [&where](const std::string& what) {
    throw SourceError(where + ": " + what + "; expected 'stamp tx ty tz qx qy qz qw' with finite numbers");
  };
  if (line.fields.size() != kValues + 1) fail(std::to_string(line.fields.size()) + " fields");
  const std::optional<std::int64_t> stamp_ns = parse_stamp_ns(line.fields[0], where);
  if (!stamp_ns) fail("stamp '" + line.fields[0] + "'");
  std::array<double, kValues> v{};
  for (std::size_t i = 0; i < kValues; ++i) {
    const std::optional<double> value = parse_number(line.fields[i + 1]);
    if (!value || !std::isfinite(*value)) fail("value '" + line.fields[i + 1] + "'");
    v[i] = *value;
  }
  const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
  if (std::abs(rotation.norm() - 1.0) > 0.05) fail("quaternion of length " + std::to_string(rotation.norm()));
  StampedPose pose{*stamp_ns, Eigen::Isometry3d::Identity()};
  pose.T_world_camera.linear() = rotation.normalized().toRotationMatrix();
  pose.T_world_camera.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  return pose;
}

}  // namespace

std::vector<StampedPose> read_tum_trajectory(const std::filesystem::path& file) {
  std::vector<StampedPose> poses;
  for (const TextLine& line : read_lines(file)) poses.push_back(parse_pose(line, at_line(file, line.number)));
  return poses;
}

std::string to_tum_trajectory(const std::vector<StampedPose>& poses) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d t = pose.T_world_camera.translation();
    const Eigen::Quaterniond q(pose.T_world_camera.linear());
    std::array<char, 256> line{};
    std::snprintf(line.data(), line.size(), "%lld.%06lld %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
                  static_cast<long long>(pose.stamp_ns / 1'000'000'000),
                  static_cast<long long>(pose.stamp_ns % 1'000'000'000 / 1000), t.x(), t.y(), t.z(), q.x(), q.y(),
                  q.z(), q.w());
    text += line.data();
  }
  return text;
}

}  // namespace rtd::camera
