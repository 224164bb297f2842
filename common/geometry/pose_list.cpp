// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/pose_list.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <stdexcept>

#include "common/io/printable.hpp"
#include "common/io/text.hpp"

namespace rtd::geometry {
namespace {

constexpr const char* kSeparators = " \t\r\v\f,;";
constexpr std::size_t kTumColumns = 8, kMatrixColumns = 13, kFullMatrixColumns = 17, kAssociationColumns = 12;

/// A value of nan or infinity: the row says that nothing was measured.
class NotFinite : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

double finite(const std::string& field) {
  const std::optional<double> value = io::parse_number(field);
  if (!value) throw std::invalid_argument("'" + io::abridged(field) + "' is not a number");
  if (!std::isfinite(*value)) throw NotFinite("'" + io::abridged(field) + "' is not a finite number");
  return *value;
}

Eigen::Isometry3d parse_matrix(std::span<const std::string> fields) {
  Eigen::Matrix<double, 3, 4> rows;
  for (Eigen::Index i = 0; i < rows.size(); ++i) rows(i / 4, i % 4) = finite(fields[static_cast<std::size_t>(i)]);
  const std::optional<Eigen::Isometry3d> pose = matrix_pose(rows);
  if (!pose) throw std::invalid_argument("its columns 2 to 13 are no pose: there is no rotation matrix in them");
  return *pose;
}

Eigen::Isometry3d quaternion_pose(std::span<const std::string> fields) {
  std::array<double, kTumColumns - 1> v{};
  for (std::size_t i = 0; i < v.size(); ++i) v.at(i) = finite(fields[i]);
  return make_pose({v[0], v[1], v[2]}, Eigen::Quaterniond(v[6], v[3], v[4], v[5]));
}

/// Stamp as it is written, and pose.
struct Row {
  std::string stamp;
  Eigen::Isometry3d T_world_body;
};

Row parse_row(const std::vector<std::string>& all) {
  std::span<const std::string> fields(all);
  if (fields.size() == kAssociationColumns && !io::parse_number(fields[1])) fields = fields.last(kTumColumns);
  const std::string stamp = stamp_in_name(fields[0]);
  finite(stamp);
  const auto pose = fields.subspan(1);
  if (fields.size() == kTumColumns) return {stamp, quaternion_pose(pose)};
  if (fields.size() == kMatrixColumns || fields.size() == kFullMatrixColumns) return {stamp, parse_matrix(pose)};
  throw std::invalid_argument(std::to_string(fields.size()) + " columns instead of 8 (stamp tx ty tz qx qy qz qw)");
}

struct Rows {
  std::vector<Row> good;
  std::size_t titles = 0, not_finite = 0, broken = 0;
  std::string first_broken;
};

Rows parse_rows(const std::string& text, const std::string& name) {
  Rows rows;
  for (const io::TextLine& line : io::split_lines(text, kSeparators)) {
    try {
      rows.good.push_back(parse_row(line.fields));
    } catch (const NotFinite&) {
      ++rows.not_finite;
    } catch (const std::invalid_argument& error) {
      const bool first = rows.good.empty() && rows.not_finite + rows.broken + rows.titles == 0;
      if (first && !io::parse_number(stamp_in_name(line.fields[0]))) {
        ++rows.titles;
        continue;
      }
      if (++rows.broken == 1) rows.first_broken = name + ":" + std::to_string(line.number) + ": " + error.what();
    }
  }
  return rows;
}

/// The decimal places of a second in a unit: 9 for ns.
struct Unit {
  int digits;
  const char* name;
};

/// Times of today in ns are above 1e17 and no stamp in s is above 9.2e9; between them the steps decide, because most
/// poses are 0.5 ms to 0.5 s apart.
Unit unit_of(const std::vector<Row>& rows) {
  constexpr double kMostSeconds = 9.2e9, kSurelyNs = 1e17, kStep_ns = 5e5, kStep_us = 5e2;
  std::vector<double> stamps, steps;
  for (const Row& row : rows) stamps.push_back(*io::parse_number(row.stamp));
  const double largest = std::ranges::max(stamps);
  if (largest <= kMostSeconds) return {0, "s"};
  for (std::size_t i = 1; i < stamps.size(); ++i) steps.push_back(std::abs(stamps[i] - stamps[i - 1]));
  if (largest >= kSurelyNs || steps.empty()) return {9, "ns"};
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  if (*middle >= kStep_ns) return {9, "ns"};
  return *middle >= kStep_us ? Unit{6, "us"} : Unit{3, "ms"};
}

/// Exact for plain decimals: a double would lose the last digits of a Unix time.
std::int64_t to_ns(const std::string& stamp, const Unit& unit) {
  if (unit.digits == 0) return io::parse_stamp_ns(stamp);
  const std::size_t point = std::min(stamp.find('.'), stamp.size());
  std::string digits = stamp.substr(0, point);
  const auto places = static_cast<std::size_t>(9 - unit.digits);
  std::string fraction = point < stamp.size() ? stamp.substr(point + 1, places) : "";
  fraction.resize(places, '0');
  digits += fraction;
  std::int64_t stamp_ns = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), stamp_ns);
  const bool plain = stamp.find_first_not_of("0123456789.") == std::string::npos;
  if (plain && error == std::errc() && end == digits.data() + digits.size()) return stamp_ns;
  const double value = *io::parse_number(stamp) * std::pow(10, 9 - unit.digits);
  if (std::abs(value) > 9.2e18) throw std::invalid_argument("stamp '" + io::abridged(stamp) + "' is out of range");
  return std::llround(value);
}

/// Of poses with one stamp, the last stays.
Trajectory each_stamp_once(const Trajectory& ordered) {
  Trajectory trajectory;
  for (const StampedPose& pose : ordered) {
    if (!trajectory.empty() && trajectory.back().stamp_ns == pose.stamp_ns) trajectory.pop_back();
    trajectory.push_back(pose);
  }
  return trajectory;
}

Trajectory in_order(const Trajectory& poses, const std::string& name, std::vector<std::string>& notes) {
  constexpr std::size_t kFewest = 5;  // poses of a segment, on average
  const std::vector<Trajectory> segments = split_where_time_goes_back(poses);
  if (segments.size() == 1) return each_stamp_once(segments.front());
  if (segments.size() * kFewest > poses.size()) {
    Trajectory sorted = poses;
    std::ranges::stable_sort(sorted, {}, &StampedPose::stamp_ns);
    notes.push_back(name + ": the rows are not in the order of their stamps: sorted");
    return each_stamp_once(sorted);
  }
  const auto longest = std::ranges::max_element(segments, {}, [](const Trajectory& segment) { return segment.size(); });
  notes.push_back(name + ": stamps go back: " + std::to_string(segments.size()) + " segments, the longest, number " +
                  std::to_string(longest - segments.begin() + 1) + " with " + std::to_string(longest->size()) + " of " +
                  std::to_string(poses.size()) + " poses, is used");
  return each_stamp_once(*longest);
}

std::string rows_text(std::size_t rows, const char* what) {
  return std::to_string(rows) + (rows == 1 ? " row " : " rows ") + what;
}

}  // namespace

std::optional<Eigen::Isometry3d> matrix_pose(const Eigen::Matrix<double, 3, 4>& rows) {
  constexpr double kMaxError = 0.01;
  const Eigen::Matrix3d R = rows.leftCols<3>();
  const double error = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kMaxError) || R.determinant() < 0) return std::nullopt;
  return make_pose(rows.col(3), Eigen::Quaterniond(R));
}

std::string stamp_in_name(const std::string& text) {
  if (io::parse_number(text)) return text;
  constexpr std::size_t kLongestName = 255;  // of a file
  const std::filesystem::path path(text);
  std::string stem = path.filename().string();
  if (stem.size() > kLongestName) return text;
  while (!stem.empty() && !io::parse_number(stem)) {
    const std::size_t dot = stem.rfind('.');
    if (dot == std::string::npos) return text;
    stem.resize(dot);
  }
  return stem.empty() ? text : stem;
}

PoseList read_pose_list(const std::string& text, const std::string& name) {
  const Rows rows = parse_rows(text, name);
  if (rows.good.empty() || rows.broken >= rows.good.size()) {
    if (!rows.first_broken.empty()) throw TrajectoryError(rows.first_broken);
    throw TrajectoryError(name + ": holds no poses" + (rows.not_finite > 0 ? ": all rows are nan" : ""));
  }
  PoseList list;
  if (rows.titles > 0) list.notes.push_back(name + ": 1 title line without '#' left out");
  if (rows.not_finite > 0) list.notes.push_back(name + ": " + rows_text(rows.not_finite, "of nan left out"));
  if (rows.broken > 0)
    list.damages.push_back(rows_text(rows.broken, "that cannot be read, first: ") + rows.first_broken);
  const Unit unit = unit_of(rows.good);
  if (unit.digits > 0) list.notes.push_back(name + ": its stamps are in " + unit.name);
  Trajectory poses;
  for (const Row& row : rows.good) {
    try {
      poses.push_back({to_ns(row.stamp, unit), row.T_world_body});
    } catch (const std::invalid_argument& error) {
      throw TrajectoryError(name + ": " + error.what());
    }
  }
  list.poses = in_order(poses, name, list.notes);
  return list;
}

PoseList read_pose_list(const std::filesystem::path& path) {
  return read_pose_list(read_poses_text(path), path.string());
}

}  // namespace rtd::geometry
