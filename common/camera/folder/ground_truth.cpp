// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/folder/ground_truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/camera/folder/frame_names.hpp"
#include "common/geometry/pose_list.hpp"
#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"

namespace rtd::camera {
namespace {

using Pose = Eigen::Isometry3d;

/// What a pose in the axes of the dataset is in ours.
Pose in_optical_axes(const Pose& T_world_body, PoseAxes axes, bool y_up) {
  Pose T_world_camera = T_world_body;
  if (axes == PoseAxes::kNed) {
    Eigen::Matrix3d R_ned_optical;
    R_ned_optical << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    T_world_camera.linear() = T_world_camera.linear() * R_ned_optical;
  }
  if (!y_up) return T_world_camera;
  const Eigen::Vector3d mirror(1, -1, 1);  // S T S: camera and world change hands
  Pose mirrored = Pose::Identity();
  mirrored.linear() = mirror.asDiagonal() * T_world_camera.linear() * mirror.asDiagonal();
  mirrored.translation() = mirror.asDiagonal() * T_world_camera.translation();
  return mirrored;
}

/// Stamps of the images in order, whether or not they have a partner.
std::vector<std::int64_t> image_stamps(const FolderContents& contents, const PairList& list) {
  std::vector<std::int64_t> stamps_ns;
  if (const NamedFrames named = read_frame_names(contents.color); named.kind != FrameNames::kNeither) {
    stamps_ns = geometry::stamps_of(named.files);
    std::ranges::sort(stamps_ns);
  }
  if (!stamps_ns.empty() && !list.pairs.empty() &&
      std::ranges::binary_search(stamps_ns, list.pairs.front().color.stamp_ns))
    return stamps_ns;
  stamps_ns.clear();
  for (const FilePair& pair : list.pairs) stamps_ns.push_back(pair.color.stamp_ns);
  return stamps_ns;
}

/// Throws io::IoError.
std::string text_of(const FolderContents& contents, const std::string& file) {
  return io::read_file(contents.folder / file, io::kPoses, contents.below(file));
}

GroundTruth not_used(const std::string& note, const std::string& cause) {
  return {{}, note, {"ground truth not used: " + cause}};
}

/// A pose of a file with one; empty for any other.
std::optional<Pose> read_pose_file(const std::string& text, const std::string& name) {
  try {
    const geometry::PoseList list = geometry::read_pose_list(text, name);
    if (list.places == 1) return list.poses.front().T_world_body;
  } catch (const geometry::TrajectoryError&) {
  }
  return std::nullopt;
}

GroundTruth read_pose_files(const FolderContents& contents, const PairList& list) {
  const NamedFrames named = read_frame_names(contents.poses);
  geometry::PoseList truth;
  for (const std::string& file : contents.poses) {
    const std::size_t i = truth.places++;
    if (const std::optional<Pose> pose = read_pose_file(text_of(contents, file), file))
      truth.poses.push_back({named.files.empty() ? static_cast<std::int64_t>(i) : named.files[i].stamp_ns, *pose});
  }
  std::ranges::sort(truth.poses, {}, &geometry::StampedPose::stamp_ns);
  std::string note = fmt::format("{} matrices next to {}", truth.poses.size(), contents.poses.front());
  if (const std::size_t lost = truth.places - truth.poses.size(); lost > 0)
    note += fmt::format(", {} left out that are no poses", lost);
  if (named.files.empty() && !geometry::give_stamps(truth, image_stamps(contents, list)))
    return not_used(note, "the names of its files do not fit those of the images");
  return {std::move(truth.poses), note, {}};
}

GroundTruth read_table(const FolderContents& contents, const PairList& list) {
  const std::string file = (contents.folder / contents.poses.front()).string();
  const auto note = [&](std::size_t poses) { return fmt::format("{} poses of {}", poses, contents.poses.front()); };
  try {
    geometry::PoseList table = geometry::read_pose_list(text_of(contents, contents.poses.front()), file);
    const std::size_t poses = table.poses.size();
    if (const auto images_ns = image_stamps(contents, list);
        table.places > 0 && !geometry::give_stamps(table, images_ns))
      return not_used(note(poses), fmt::format("{} has {} poses without stamps, there are {} images", file,
                                               table.places, images_ns.size()));
    std::ranges::move(table.damages, std::back_inserter(table.notes));
    return {std::move(table.poses), note(poses), std::move(table.notes)};
  } catch (const geometry::TrajectoryError& error) {
    return not_used(note(0), error.what());
  }
}

}  // namespace

GroundTruth read_ground_truth(const FolderContents& contents, const PairList& list, bool y_up) {
  if (contents.poses.empty()) return {};
  GroundTruth truth;
  try {
    truth = contents.poses.size() > 1 ? read_pose_files(contents, list) : read_table(contents, list);
  } catch (const io::IoError& error) {
    truth.remarks.push_back("ground truth not used: " + why_unread(error));
  }
  for (geometry::StampedPose& pose : truth.poses)
    pose.T_world_body = in_optical_axes(pose.T_world_body, contents.layout->axes, y_up);
  return truth;
}

geometry::Trajectory retimed(const geometry::Trajectory& poses, const std::vector<std::int64_t>& old_ns,
                             const std::vector<std::int64_t>& new_ns, std::int64_t max_gap_ns) {
  geometry::Trajectory result;
  for (std::size_t i = 0; i < old_ns.size(); ++i)
    if (const auto pose = geometry::pose_at(poses, old_ns[i], max_gap_ns)) result.push_back({new_ns[i], *pose});
  return result;
}

}  // namespace rtd::camera
