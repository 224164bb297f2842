// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/trajectory.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

namespace rtd::eval {
namespace {

constexpr std::size_t kColumns = 8;
constexpr double kQuaternionTolerance = 0.01;
constexpr double kMaxStampS = 9.2e9;  // int64 nanoseconds end at 9.22e9 s

[[noreturn]] void fail(const std::string& name, std::size_t line, const std::string& cause) {
  throw TrajectoryError(name + ":" + std::to_string(line) + ": " + cause);
}

std::vector<std::string> split_columns(const std::string& line) {
  constexpr std::string_view kSeparators = " \t\r,;";
  std::vector<std::string> columns;
  std::size_t begin = line.find_first_not_of(kSeparators);
  while (begin != std::string::npos) {
    const std::size_t end = line.find_first_of(kSeparators, begin);
    columns.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kSeparators, end);
  }
  return columns;
}

double parse_number(const std::string& text) {
  const std::string_view digits = std::string_view(text).substr(!text.empty() && text.front() == '+' ? 1 : 0);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) {
    throw std::invalid_argument("'" + text + "' is not a number");
  }
  if (!std::isfinite(value)) throw std::invalid_argument("'" + text + "' is not a finite number; leave such rows out");
  return value;
}

bool is_plain_decimal(const std::string& text) {
  return text.find_first_not_of("0123456789.") == std::string::npos;
}

Eigen::Isometry3d parse_pose(const std::vector<std::string>& columns) {
  std::array<double, kColumns - 1> v{};
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = parse_number(columns[i + 1]);
  const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
  if (std::abs(rotation.norm() - 1) > kQuaternionTolerance) {
    throw std::invalid_argument("quaternion has length " + std::to_string(rotation.norm()) +
                                " instead of 1 (columns are: stamp tx ty tz qx qy qz qw)");
  }
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();
  T_world_body.linear() = rotation.normalized().toRotationMatrix();
  T_world_body.translation() << v[0], v[1], v[2];
  return T_world_body;
}

StampedPose parse_row(const std::string& line) {
  const std::vector<std::string> columns = split_columns(line);
  if (columns.size() != kColumns) {
    throw std::invalid_argument(std::to_string(columns.size()) + " columns instead of 8 (stamp tx ty tz qx qy qz qw)");
  }
  return {parse_stamp_ns(columns[0]), parse_pose(columns)};
}

bool is_comment_or_blank(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first == std::string::npos || line[first] == '#';
}

void append_in_order(Trajectory& trajectory, const StampedPose& pose) {
  if (!trajectory.empty() && pose.stamp_ns < trajectory.back().stamp_ns) {
    throw std::invalid_argument("stamp is earlier than the one before it; sort the file by its first column");
  }
  if (!trajectory.empty() && pose.stamp_ns == trajectory.back().stamp_ns) trajectory.pop_back();
  trajectory.push_back(pose);
}

std::ifstream open_or_throw(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw TrajectoryError(path.string() + ": no such file; check the path");
  if (std::filesystem::is_directory(path)) {
    throw TrajectoryError(path.string() + ": is a folder; name the trajectory file in it");
  }
  std::ifstream input(path);
  if (!input) throw TrajectoryError(path.string() + ": cannot be opened; check its permissions");
  return input;
}

}  // namespace

std::int64_t parse_stamp_ns(const std::string& text) {
  const double stamp_s = parse_number(text);
  if (std::abs(stamp_s) > kMaxStampS) {
    throw std::invalid_argument("stamp '" + text + "' is out of range; stamps are in seconds, not nanoseconds");
  }
  const std::size_t point = text.find('.');
  if (!is_plain_decimal(text) || (point != std::string::npos && text.size() - point - 1 > 9)) {
    return std::llround(stamp_s * 1e9);
  }
  // A double holds a Unix time to 0.2 us only: whole seconds and fraction are read apart.
  const std::string whole = text.substr(0, point);
  std::string fraction = point == std::string::npos ? "" : text.substr(point + 1);
  fraction.resize(9, '0');
  return (whole.empty() ? 0 : std::stoll(whole)) * 1'000'000'000 + std::stoll(fraction);
}

Trajectory read_tum_trajectory(std::istream& input, const std::string& name) {
  Trajectory trajectory;
  std::string line;
  for (std::size_t number = 1; std::getline(input, line); ++number) {
    if (is_comment_or_blank(line)) continue;
    try {
      append_in_order(trajectory, parse_row(line));
    } catch (const std::invalid_argument& error) {
      fail(name, number, error.what());
    }
  }
  if (trajectory.empty()) throw TrajectoryError(name + ": holds no poses");
  return trajectory;
}

Trajectory read_tum_trajectory(const std::filesystem::path& path) {
  std::ifstream input = open_or_throw(path);
  return read_tum_trajectory(input, path.string());
}

std::vector<std::int64_t> read_frame_stamps(const std::filesystem::path& path) {
  std::ifstream input = open_or_throw(path);
  std::vector<std::int64_t> stamps_ns;
  std::string line;
  for (std::size_t number = 1; std::getline(input, line); ++number) {
    if (is_comment_or_blank(line)) continue;
    try {
      stamps_ns.push_back(parse_stamp_ns(split_columns(line).at(0)));
    } catch (const std::logic_error& error) {
      fail(path.string(), number, error.what());
    }
  }
  if (stamps_ns.empty()) throw TrajectoryError(path.string() + ": holds no frames");
  return stamps_ns;
}

std::vector<std::int64_t> stamps_of(const Trajectory& trajectory) {
  std::vector<std::int64_t> stamps_ns;
  stamps_ns.reserve(trajectory.size());
  for (const StampedPose& pose : trajectory) stamps_ns.push_back(pose.stamp_ns);
  return stamps_ns;
}

}  // namespace rtd::eval
