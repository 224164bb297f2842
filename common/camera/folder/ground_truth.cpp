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
#include "common/io/text.hpp"

namespace rtd::camera {
namespace {

using Numbers = std::vector<double>;
using Pose = Eigen::Isometry3d;

/// What a table without stamps, or EuRoC's, holds; poses without stamps count from 0.
struct Table {
  geometry::Trajectory poses;
  bool stamped = false;
  std::size_t left_out = 0;
  std::string problem;  ///< the first row that was left out
};

std::optional<Pose> to_pose(const Eigen::Vector3d& t, double qx, double qy, double qz, double qw) {
  try {
    return geometry::make_pose(t, Eigen::Quaterniond(qw, qx, qy, qz));
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

/// The upper three rows of a matrix, row by row.
std::optional<Pose> matrix_pose(const double* m) {
  constexpr double kNearlyOrthonormal = 0.05;
  Eigen::Matrix3d rotation;
  rotation << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  if (!((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < kNearlyOrthonormal))
    return std::nullopt;
  if (rotation.determinant() < 0) return std::nullopt;
  const Eigen::Quaterniond q(rotation);
  return to_pose({m[3], m[7], m[11]}, q.x(), q.y(), q.z(), q.w());
}

/// Seconds with all their digits, or nanoseconds.
std::optional<std::int64_t> stamp_of(const std::string& text) {
  constexpr double kLatest_s = 1e10;
  const std::optional<double> number = io::parse_number(text);
  if (!number || !std::isfinite(*number) || std::abs(*number) > 9e18) return std::nullopt;
  if (std::abs(*number) < kLatest_s) return io::parse_stamp_ns(text);
  const bool whole = text.find_first_not_of("0123456789") == std::string::npos;
  return whole && text.size() < 19 + 1 ? static_cast<std::int64_t>(std::stoull(text)) : std::llround(*number);
}

bool is_csv(const std::filesystem::path& file) {
  return file.extension() == ".csv";
}

/// Reads what has no stamps, and EuRoC's table; stamped poses of others are read_pose_list()'s.
class TableReader {
 public:
  Table read(const std::string& text, bool csv) {
    for (const io::TextLine& line : io::split_lines(text, " \t\r\v\f,;[]")) take(line, csv);
    std::ranges::stable_sort(table_.poses, {}, &geometry::StampedPose::stamp_ns);
    const auto repeated = std::ranges::unique(table_.poses, {}, &geometry::StampedPose::stamp_ns);
    table_.poses.erase(repeated.begin(), repeated.end());
    return table_;
  }

 private:
  void take(const io::TextLine& line, bool csv) {
    Numbers n;
    for (const std::string& field : line.fields) {
      const std::optional<double> number = io::parse_number(field);
      if (!number) return leave_out(line);
      n.push_back(*number);
    }
    if (n.size() == 3) return rows_.clear();  // the line before a matrix
    if (n.size() == 4) return take_row(n, line);
    if (n.size() == 12 || n.size() == 16) return add(count_++, matrix_pose(n.data()), line);
    if (n.size() == 7) return add(count_++, to_pose({n[0], n[1], n[2]}, n[3], n[4], n[5], n[6]), line);
    const std::optional<std::int64_t> stamp_ns = stamp_of(line.fields[0]);
    const bool euroc = n.size() > 8 || (csv && n.size() == 8);
    if (!stamp_ns || !euroc) return leave_out(line);
    table_.stamped = true;
    add(*stamp_ns, to_pose({n[1], n[2], n[3]}, n[5], n[6], n[7], n[4]), line);
  }

  void take_row(const Numbers& row, const io::TextLine& line) {
    rows_.insert(rows_.end(), row.begin(), row.end());
    if (rows_.size() < 16) return;
    add(count_++, matrix_pose(rows_.data()), line);
    rows_.clear();
  }

  /// A row without a stamp takes a place even where it is no pose.
  void add(std::int64_t stamp_ns, const std::optional<Pose>& pose, const io::TextLine& line) {
    if (!pose) return leave_out(line);
    table_.poses.push_back({stamp_ns, *pose});
  }

  void leave_out(const io::TextLine& line) {
    if (table_.left_out++ == 0) table_.problem = fmt::format("line {} is no pose", line.number);
  }

  Table table_;
  Numbers rows_;
  std::int64_t count_ = 0;

 public:
  std::int64_t count() const { return count_; }
};

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

/// Gives poses that count from 0 the stamps of the images; false when there are not as many.
bool give_stamps(geometry::Trajectory& poses, std::int64_t count, const std::vector<std::int64_t>& images_ns) {
  if (count != static_cast<std::int64_t>(images_ns.size())) return false;
  for (geometry::StampedPose& pose : poses) pose.stamp_ns = images_ns[static_cast<std::size_t>(pose.stamp_ns)];
  return true;
}

/// Throws io::IoError.
std::string text_of(const FolderContents& contents, const std::string& file) {
  return io::read_file(contents.folder / file, io::kPoses, contents.below(file));
}

GroundTruth read_pose_files(const FolderContents& contents, const PairList& list) {
  const NamedFrames named = read_frame_names(contents.poses);
  GroundTruth truth;
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < contents.poses.size(); ++i) {
    const Table one = TableReader().read(text_of(contents, contents.poses[i]), false);
    const bool fits = one.poses.size() == 1 && !one.stamped;
    left_out += !fits;
    if (fits)
      truth.poses.push_back({named.files.empty() ? static_cast<std::int64_t>(i) : named.files[i].stamp_ns,
                             one.poses.front().T_world_body});
  }
  std::ranges::sort(truth.poses, {}, &geometry::StampedPose::stamp_ns);
  truth.note = fmt::format("{} matrices next to {}", truth.poses.size(), contents.poses.front());
  if (left_out > 0) truth.note += fmt::format(", {} left out that are no poses", left_out);
  if (named.files.empty() &&
      !give_stamps(truth.poses, static_cast<std::int64_t>(contents.poses.size()), image_stamps(contents, list)))
    return {{}, truth.note, {"ground truth not used: the names of its files do not fit those of the images"}};
  return truth;
}

std::string poses_of(std::size_t poses, const FolderContents& contents) {
  return fmt::format("{} poses of {}", poses, contents.poses.front());
}

/// Empty where it is another kind of table; then `problem` says what a list of stamped poses would need.
std::optional<GroundTruth> read_stamped(const FolderContents& contents, const std::string& text, std::string& problem) {
  try {
    geometry::PoseList list = geometry::read_pose_list(text, (contents.folder / contents.poses.front()).string());
    std::ranges::move(list.damages, std::back_inserter(list.notes));
    const std::size_t poses = list.poses.size();
    return GroundTruth{std::move(list.poses), poses_of(poses, contents), std::move(list.notes)};
  } catch (const geometry::TrajectoryError& error) {
    problem = error.what();
    return std::nullopt;
  }
}

GroundTruth read_table(const FolderContents& contents, const PairList& list) {
  const std::filesystem::path file = contents.folder / contents.poses.front();
  const std::string text = text_of(contents, contents.poses.front());
  std::string problem;
  if (!is_csv(file)) {
    if (std::optional<GroundTruth> stamped = read_stamped(contents, text, problem)) return std::move(*stamped);
  }
  TableReader reader;
  Table table = reader.read(text, is_csv(file));
  const std::string note = poses_of(table.poses.size(), contents);
  std::vector<std::string> remarks;
  if (table.left_out > 0)
    remarks.push_back(fmt::format("{}: {} rows left out, first: {}", file.string(), table.left_out, table.problem));
  if (table.poses.empty()) {
    const std::string& cause = problem.empty() ? table.problem : problem;
    return {{}, note, {"ground truth not used: " + (cause.empty() ? file.string() + ": holds no poses" : cause)}};
  }
  if (!table.stamped) {
    const std::vector<std::int64_t> images_ns = image_stamps(contents, list);
    if (!give_stamps(table.poses, reader.count(), images_ns))
      return {{},
              note,
              {fmt::format("ground truth not used: {} has {} poses without stamps, there are {} images", file.string(),
                           reader.count(), images_ns.size())}};
  }
  return {std::move(table.poses), note, std::move(remarks)};
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
