// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/datasets/dataset.hpp"

#include <opencv2/core.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/camera/calibration.hpp"
#include "common/camera/frame_source.hpp"
#include "common/geometry/pose_list.hpp"
#include "common/io/atomic_file.hpp"
#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "common/io/text.hpp"

namespace rtd::eval {
namespace fs = std::filesystem;
namespace {

using camera::SourceError;

constexpr const char* kColorFrame = "d400_color_optical_frame";

/// A file of a sequence, which links do not lead out of. Throws SourceError.
std::string read_below(const fs::path& file, const io::ReadAs& as) {
  try {
    return io::read_file(file, as, file.parent_path());
  } catch (const io::IoError& error) {
    throw SourceError(error.what());
  }
}

/// A file of OpenCV's YAML. Throws SourceError.
cv::FileStorage open_yaml(const fs::path& file) {
  const std::string text = read_below(file, io::kSettings);
  try {
    cv::FileStorage yaml(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
    if (yaml.isOpened()) return yaml;
  } catch (const cv::Exception&) {
  }
  throw SourceError(file.string() + " cannot be read as OpenCV's YAML: take it from the dataset again");
}

std::vector<double> numbers_of(const cv::FileNode& node) {
  cv::Mat matrix;
  if (!node.empty()) node >> matrix;
  if (matrix.empty()) return {};
  matrix.convertTo(matrix, CV_64F);
  return matrix.reshape(1, 1).clone();
}

/// A transform of trans_matrix.yaml.
struct Link {
  std::string parent, child;
  Eigen::Isometry3d T_parent_child;
};

std::vector<Link> read_links(const fs::path& file) {
  cv::FileStorage yaml = open_yaml(file);
  std::vector<Link> links;
  for (const cv::FileNode& node : yaml["trans_matrix"]) {
    const std::vector<double> values = numbers_of(node["matrix"]);
    if (values.size() != 16) throw SourceError(file.string() + ": a matrix is not 4 x 4");
    Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();
    T_parent_child.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
    links.push_back({node["parent_frame"].string(), node["child_frame"].string(), T_parent_child});
  }
  return links;
}

/// Follows the links in both directions to the camera; passes through each frame once.
std::optional<Eigen::Isometry3d> T_frame_camera(const std::string& frame, const std::vector<Link>& links,
                                                std::set<std::string>& passed) {
  if (frame == kColorFrame) return Eigen::Isometry3d::Identity();
  if (!passed.insert(frame).second) return std::nullopt;
  for (const Link& link : links) {
    if (link.parent != frame && link.child != frame) continue;
    const bool down = link.parent == frame;
    if (const auto T_next_camera = T_frame_camera(down ? link.child : link.parent, links, passed))
      return (down ? link.T_parent_child : link.T_parent_child.inverse()) * *T_next_camera;
  }
  return std::nullopt;
}

/// The ground truth without its title lines, "scene: cafe", "frame: gt_map base_link".
struct Groundtruth {
  std::string body = "base_link";
  geometry::Trajectory poses;
};

Groundtruth read_groundtruth(const fs::path& file) {
  Groundtruth truth;
  std::string rows;
  for (const io::TextLine& line : io::split_lines(read_below(file, io::kPoses))) {
    if (line.fields[0] == "frame:") truth.body = line.fields.back();
    if (!io::parse_number(line.fields[0])) continue;
    for (const std::string& field : line.fields) rows += field + ' ';
    rows += '\n';
  }
  try {
    truth.poses = geometry::read_pose_list(rows, file.string()).poses;
  } catch (const geometry::TrajectoryError& error) {
    throw SourceError(error.what());
  }
  return truth;
}

geometry::Trajectory of_camera(const fs::path& sequence) {
  Groundtruth truth = read_groundtruth(sequence / "groundtruth.txt");
  const fs::path file = sequence / "trans_matrix.yaml";
  std::set<std::string> passed;
  const auto T_body_camera = T_frame_camera(truth.body, read_links(file), passed);
  if (!T_body_camera)
    throw SourceError(file.string() + ": no transforms lead from " + truth.body + " to " + kColorFrame +
                      ": take the file from the dataset again");
  for (geometry::StampedPose& pose : truth.poses) pose.T_world_body = pose.T_world_body * *T_body_camera;
  return truth.poses;
}

void copy_list(const fs::path& from, const fs::path& to) {
  io::write_file(to, read_below(from, io::kFrameList));
}

/// A link may be left from an earlier call.
void link_folder(const fs::path& target, const fs::path& link) {
  std::error_code ignored;
  if (fs::is_symlink(link, ignored)) fs::remove(link, ignored);
  fs::create_directory_symlink(fs::absolute(target), link);
}

}  // namespace

void prepare_openloris(const fs::path& sequence, const fs::path& into) {
  const camera::Calibration calibration = camera::read_calibration(sequence / "sensors.yaml", std::nullopt, sequence);
  const geometry::Trajectory groundtruth = of_camera(sequence);
  fs::create_directories(into);
  io::write_file(into / "calibration.yaml", camera::to_yaml(calibration));
  io::write_file(into / "groundtruth.txt", [&](std::ostream& out) {
    geometry::write_tum_trajectory(out, groundtruth, geometry::TumStyle::kGroundtruth);
  });
  copy_list(sequence / "color.txt", into / "rgb.txt");
  copy_list(sequence / "aligned_depth.txt", into / "depth.txt");
  for (const char* images : {"color", "aligned_depth"}) link_folder(sequence / images, into / images);
}

}  // namespace rtd::eval
