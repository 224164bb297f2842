// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/pose_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <sstream>

#include "common/geometry/pose_list.hpp"
#include "common/io/printable.hpp"
#include "common/io/recording_forms.hpp"
#include "common/io/text.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/recordings/open.hpp"
#include "common/recordings/parts.hpp"
#include "services/evaluation/core/trajectory/recorded_poses.hpp"

namespace rtd::eval {
namespace {

/// The formats of trajectories in text.
enum class PoseFormat { kTum, kKitti, kEuroc };

using geometry::StampedPose;
using geometry::Trajectory;
using geometry::TrajectoryError;

constexpr std::size_t kKittiColumns = 12, kFullMatrixColumns = 16;
constexpr std::size_t kNsDigits = 16;  // seconds have at most 10 before their point
constexpr const char* kKittiSeparators = " \t\r\v\f";
constexpr const char* kCsvSeparators = " \t\r,;";

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

/// With or without '#', which made for other programs it may lack.
bool is_euroc_title(const std::string& line) {
  const auto has = [&](const char* text) { return line.find(text) != std::string::npos; };
  const bool titled = !line.empty() && (line[0] == '#' || std::isalpha(static_cast<unsigned char>(line[0])) != 0);
  return titled && has("timestamp") && has(",") && has("p_");
}

bool is_ns(const std::string& field) {
  return field.size() >= kNsDigits && std::ranges::all_of(field, [](unsigned char c) { return std::isdigit(c) != 0; });
}

double number(const std::string& field) {
  const std::optional<double> value = io::parse_number(field);
  if (!value) throw std::invalid_argument("'" + io::abridged(field) + "' is not a number");
  return *value;
}

/// Calls `work` with each line; adds file and line to what it throws.
void for_each_line(const std::string& text, const std::string& name, const char* separators,
                   const std::function<void(const std::vector<std::string>&)>& work) {
  for (const io::TextLine& line : io::split_lines(text, separators)) {
    try {
      work(line.fields);
    } catch (const std::invalid_argument& error) {
      throw TrajectoryError(name + ":" + std::to_string(line.number) + ": " + error.what());
    }
  }
}

Eigen::Isometry3d kitti_pose(const std::vector<std::string>& fields) {
  if (fields.size() != kKittiColumns && fields.size() != kFullMatrixColumns)
    throw std::invalid_argument(std::to_string(fields.size()) + " numbers instead of 12 (the upper 3 x 4 of a pose)");
  Eigen::Matrix<double, 3, 4> rows;
  for (std::size_t i = 0; i < kKittiColumns; ++i)
    rows(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = number(fields[i]);
  const std::optional<Eigen::Isometry3d> pose = geometry::matrix_pose(rows);
  if (!pose) throw std::invalid_argument("columns 1 to 3, 5 to 7 and 9 to 11 are no rotation matrix");
  return *pose;
}

/// Where a csv file has its values.
struct EurocColumns {
  std::array<std::size_t, 8> at{0, 1, 2, 3, 4, 5, 6, 7};  ///< time, p_x p_y p_z, q_w q_x q_y q_z
  std::size_t most() const { return *std::ranges::max_element(at); }
};

std::vector<std::string> split_title(const std::string& line) {
  std::vector<std::string> names;
  const std::string title = line.starts_with('#') ? line.substr(1) : line;
  for (const io::TextLine& part : io::split_lines(title + "\n", "\r,;")) names = part.fields;
  for (std::string& name : names) {
    name.erase(0, std::min(name.size(), name.find_first_not_of(' ')));
    name.resize(std::min(name.size(), name.find_first_of(" [")));
  }
  return names;
}

/// "p_RS_R_x" is "p_x", and "q_RS_w" is "q_w".
EurocColumns columns_of(const std::string& title, const std::string& name) {
  constexpr std::array<const char*, 8> kWanted = {"t", "p_x", "p_y", "p_z", "q_w", "q_x", "q_y", "q_z"};
  const std::vector<std::string> names = split_title(title);
  EurocColumns columns;
  for (std::size_t i = 1; i < kWanted.size(); ++i) {
    const std::string wanted = kWanted[i];
    const auto fits = [&](const std::string& column) {
      return column.starts_with(wanted[0]) && column.ends_with(wanted.substr(1));
    };
    const auto found = std::ranges::find_if(names, fits);
    if (found == names.end()) {
      throw TrajectoryError(name + ":1: the title names no column " + wanted +
                            "; expected: #timestamp [ns], p_x, p_y, p_z, q_w, q_x, q_y, q_z");
    }
    columns.at[i] = static_cast<std::size_t>(found - names.begin());
  }
  return columns;
}

std::int64_t stamp_of(const std::string& field) {
  std::int64_t stamp_ns = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), stamp_ns);
  if (error != std::errc() || end != field.data() + field.size() || stamp_ns < 0)
    throw std::invalid_argument("'" + io::abridged(field) + "' is not a stamp in nanoseconds");
  return stamp_ns;
}

/// Whether no value of the pose is nan or infinite.
bool measured(const std::vector<std::string>& fields, const EurocColumns& columns) {
  return std::ranges::none_of(columns.at, [&](std::size_t column) {
    const auto value = column < fields.size() ? io::parse_number(fields[column]) : std::nullopt;
    return value && !std::isfinite(*value);
  });
}

StampedPose euroc_pose(const std::vector<std::string>& fields, const EurocColumns& columns) {
  if (fields.size() <= columns.most()) {
    throw std::invalid_argument(std::to_string(fields.size()) + " columns instead of at least " +
                                std::to_string(columns.most() + 1) + " (time [ns], position, quaternion)");
  }
  const auto value = [&](std::size_t i) { return number(fields[columns.at[i]]); };
  return {stamp_of(fields[columns.at[0]]),
          geometry::make_pose({value(1), value(2), value(3)}, {value(4), value(5), value(6), value(7)})};
}

void require_poses(const Trajectory& trajectory, const std::string& name) {
  if (trajectory.empty()) throw TrajectoryError(name + ": holds no poses");
}

/// By the first lines: EuRoC's title "#timestamp [ns],..." or stamps in nanoseconds before commas; KITTI's 12 numbers a
/// line, or the 16 of a whole matrix; a list of poses for everything else.
PoseFormat format_of(const std::string& text) {
  if (is_euroc_title(first_line(text))) return PoseFormat::kEuroc;
  const std::size_t begin = text.find_first_not_of("\r\n");
  if (begin == std::string::npos) return PoseFormat::kTum;
  const std::string line = first_line(text.substr(begin, 4096));
  const std::vector<io::TextLine> csv = io::split_lines(line, kCsvSeparators);
  if (csv.empty()) return PoseFormat::kTum;
  if (line.find(',') != std::string::npos && is_ns(csv.front().fields.front())) return PoseFormat::kEuroc;
  const std::vector<std::string>& fields = csv.front().fields;
  const bool matrix = fields.size() == kKittiColumns || fields.size() == kFullMatrixColumns;
  return matrix && io::parse_number(fields[1]) ? PoseFormat::kKitti : PoseFormat::kTum;
}

/// The number of poses in such a text.
std::size_t count_kitti(const std::string& text) {
  return io::split_lines(text, kKittiSeparators).size();
}

/// KITTI's odometry format: the upper 3 x 4 of T_world_camera, row by row, without stamp; pose i is of `stamps_ns`[i].
/// Throws geometry::TrajectoryError, which names `name` and the line: another number of columns, no rotation, another
/// number of poses than stamps, no pose.
Trajectory read_kitti(const std::string& text, const std::string& name, const std::vector<std::int64_t>& stamps_ns) {
  if (const std::size_t poses = count_kitti(text); poses != stamps_ns.size()) {
    throw TrajectoryError(name + ": has " + std::to_string(poses) + " poses, but there are " +
                          std::to_string(stamps_ns.size()) + " stamps; name the times of this sequence");
  }
  Trajectory trajectory;
  std::size_t index = 0;
  for_each_line(text, name, kKittiSeparators, [&](const std::vector<std::string>& fields) {
    geometry::append_in_order(trajectory, {stamps_ns[index++], kitti_pose(fields)});
  });
  require_poses(trajectory, name);
  return trajectory;
}

/// EuRoC's csv: stamps in nanoseconds, columns by the names in the title (p_x or p_RS_R_x [m], q_w, ...; others are
/// ignored), without title: time, p_x, p_y, p_z, q_w, q_x, q_y, q_z. Throws geometry::TrajectoryError.
PoseFile read_euroc(const std::string& text, const std::string& name) {
  const std::string title = first_line(text);
  const bool titled = is_euroc_title(title);
  const EurocColumns columns = titled ? columns_of(title, name) : EurocColumns{};
  const std::string rest = titled && !title.starts_with('#') ? '#' + text : text;
  PoseFile file;
  std::size_t not_finite = 0;
  for_each_line(rest, name, kCsvSeparators, [&](const std::vector<std::string>& fields) {
    if (measured(fields, columns)) {
      geometry::append_in_order(file.poses, euroc_pose(fields, columns));
    } else {
      ++not_finite;
    }
  });
  require_poses(file.poses, name);
  if (not_finite > 0) file.notes.push_back(name + ": " + std::to_string(not_finite) + " rows of nan left out");
  return file;
}

namespace fs = std::filesystem;
using geometry::TrajectoryError;

/// FILE?topic=/x&child=FRAME, unless a file has the whole name.
struct PoseArgument {
  fs::path file;
  PoseChoice choice;
  bool chosen = false;
};

PoseArgument parse(const std::string& text) {
  std::error_code none;
  if (fs::exists(text, none)) return {text, {}, false};
  const std::size_t question = text.find('?');
  if (question == std::string::npos) return {text, {}, false};
  PoseArgument argument{text.substr(0, question), {}, true};
  std::istringstream parameters(text.substr(question + 1));
  for (std::string part; std::getline(parameters, part, '&');) {
    const std::size_t equals = part.find('=');
    const std::string key = part.substr(0, equals), value = equals == std::string::npos ? "" : part.substr(equals + 1);
    if ((key != "topic" && key != "child") || value.empty())
      throw TrajectoryError(text + ": parameter '" + part +
                            "'; expected: FILE?topic=TOPIC or FILE?topic=TOPIC&child=FRAME");
    (key == "topic" ? argument.choice.topic : argument.choice.child) = value;
  }
  return argument;
}

bool is_recording(const fs::path& file) {
  try {
    if (std::error_code none; fs::is_directory(file, none)) return recordings::holds_recording(file);
    return recordings::is_recording(file.string()) || io::is_recording_name(file);
  } catch (const mcap::RecordingFileError&) {
    return false;  // read_text_file() says why it cannot be read
  }
}

std::vector<std::int64_t> stamps_for(std::size_t poses, const MissingStamps& given) {
  if (!given.times_file.empty()) return geometry::read_frame_stamps(given.times_file);
  const double rate_hz = given.rate_hz > 0 ? given.rate_hz : kNumberedHz;
  std::vector<std::int64_t> stamps_ns(poses);
  for (std::size_t i = 0; i < poses; ++i) stamps_ns[i] = std::llround(static_cast<double>(i) * 1e9 / rate_hz);
  return stamps_ns;
}

PoseFile read_text_file(const fs::path& path, const MissingStamps& stamps) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  const std::string name = path.string();
  std::string text = geometry::read_poses_text(path);
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  const PoseFormat format = format_of(text);
  if (format == PoseFormat::kEuroc) return read_euroc(text, name);
  PoseFile file;
  if (format == PoseFormat::kKitti) {
    file.poses = read_kitti(text, name, stamps_for(count_kitti(text), stamps));
    file.took_stamps = stamps.rate_hz > 0 || !stamps.times_file.empty();
    file.numbered = !file.took_stamps;
    return file;
  }
  geometry::PoseList list = geometry::read_pose_list(text, name);
  file.poses = std::move(list.poses);
  file.notes = std::move(list.notes);
  file.damages = std::move(list.damages);
  return file;
}

PoseFile read_results_file(recordings::Reader& recording, const std::string& topic) {
  RecordedResults recorded = read_recorded_results(recording, topic);
  PoseFile file;
  file.poses = measured_poses(recorded.published);
  file.damages = std::move(recorded.damages);
  if (file.poses.empty()) throw TrajectoryError(recording.name() + ": topic " + topic + " has no measured pose");
  file.published = std::move(recorded.published);
  return file;
}

}  // namespace

PoseFile read_pose_file(const std::string& argument, const MissingStamps& stamps) {
  const PoseArgument wanted = parse(argument);
  std::error_code none;
  const bool exists = fs::exists(wanted.file, none);
  if (exists && is_recording(wanted.file)) {
    const auto reader = recordings::open_reader(wanted.file);
    if (const auto results = topic_of_results(*reader, wanted.choice)) return read_results_file(*reader, *results);
    RecordedPoses recorded = read_recorded_poses(*reader, wanted.choice);
    PoseFile file;
    file.poses = std::move(recorded.poses);
    file.damages = std::move(recorded.damages);
    return file;
  }
  if (wanted.chosen && exists)
    throw TrajectoryError(argument + ": topic and child are for recordings (bag, MCAP, .db3), the file is none");
  return read_text_file(wanted.file, stamps);
}

}  // namespace rtd::eval
