// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/pose_list.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <span>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/io/printable.hpp"
#include "common/io/text.hpp"

namespace rtd::geometry {
namespace {

constexpr const char* kSeparators = " \t\r\v\f,;[]";
constexpr std::size_t kTumColumns = 8, kAssociationColumns = 12, kMatrixColumns = 12, kFullMatrixColumns = 16;

using Fields = std::span<const std::string>;

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

bool is_matrix(std::size_t columns) {
  return columns == kMatrixColumns || columns == kFullMatrixColumns;
}

Eigen::Isometry3d parse_matrix(Fields fields) {
  Eigen::Matrix<double, 3, 4> rows;
  for (Eigen::Index i = 0; i < rows.size(); ++i) rows(i / 4, i % 4) = finite(fields[static_cast<std::size_t>(i)]);
  const std::optional<Eigen::Isometry3d> pose = matrix_pose(rows);
  if (!pose) throw std::invalid_argument("its matrix is no pose: there is no rotation matrix in it");
  return *pose;
}

Eigen::Isometry3d quaternion_pose(Fields fields) {
  std::array<double, kTumColumns - 1> v{};
  for (std::size_t i = 0; i < v.size(); ++i) v.at(i) = finite(fields[i]);
  return make_pose({v[0], v[1], v[2]}, Eigen::Quaterniond(v[6], v[3], v[4], v[5]));
}

/// What the rows of a text are.
struct Form {
  enum class Kind {
    kStamped,
    kEuroc,
    kNumbered,  ///< a pose without stamp a row: KITTI's, TartanAir's
    kBlocks     ///< a matrix in four rows, with or without a row of three numbers before it: Redwood's
  } kind = Kind::kStamped;
  /// EuRoC's columns of the time, p_x p_y p_z, q_x q_y q_z q_w
  std::array<std::size_t, kTumColumns> columns{0, 1, 2, 3, 5, 6, 7, 4};
};

std::string line_of(std::string_view text, int number) {
  for (int i = 1; i < number; ++i) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  return std::string(text.substr(0, text.find('\n')));
}

/// With or without '#', which made for other programs it may lack.
bool is_euroc_title(const std::string& line) {
  const auto has = [&](const char* text) { return line.find(text) != std::string::npos; };
  const bool titled = !line.empty() && (line[0] == '#' || std::isalpha(static_cast<unsigned char>(line[0])) != 0);
  return titled && has("timestamp") && has(",") && has("p_");
}

bool is_ns(const std::string& field) {
  constexpr std::size_t kNsDigits = 16;  // seconds have at most 10 before their point
  return field.size() >= kNsDigits && std::ranges::all_of(field, [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// By the names in the title: "p_RS_R_x [m]" is "p_x", and "q_RS_w []" is "q_w".
Form euroc_form(const std::string& title, const std::string& name) {
  constexpr std::array<const char*, 8> kWanted = {"t", "p_x", "p_y", "p_z", "q_x", "q_y", "q_z", "q_w"};
  std::vector<std::string> names;
  std::istringstream parts(title);
  for (std::string part; std::getline(parts, part, ',');) {
    part.erase(0, std::min(part.size(), part.find_first_not_of(" #")));
    names.push_back(part.substr(0, part.find_first_of(" [\r")));
  }
  Form form{Form::Kind::kEuroc, {}};
  for (std::size_t i = 1; i < kWanted.size(); ++i) {
    const std::string wanted = kWanted.at(i);
    const auto found = std::ranges::find_if(names, [&](const std::string& column) {
      return column.starts_with(wanted[0]) && column.ends_with(wanted.substr(1));
    });
    if (found == names.end()) {
      throw TrajectoryError(name + ":1: the title names no column " + wanted +
                            "; expected: #timestamp [ns], p_x, p_y, p_z, q_w, q_x, q_y, q_z");
    }
    form.columns.at(i) = static_cast<std::size_t>(found - names.begin());
  }
  return form;
}

bool is_title(const io::TextLine& line) {
  return !io::parse_number(stamp_in_name(line.fields[0]));
}

/// By the title and the first row.
Form form_of(const std::string& text, const std::vector<io::TextLine>& lines, const std::string& name) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  const std::string title = line_of(text, 1).substr(text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0);
  if (is_euroc_title(title)) return euroc_form(title, name);
  const auto first = std::ranges::find_if_not(lines, is_title);
  if (first == lines.end()) return {};
  const std::vector<std::string>& fields = first->fields;
  if (is_ns(fields[0]) && line_of(text, first->number).find(',') != std::string::npos) return {Form::Kind::kEuroc};
  if (is_matrix(fields.size()) && io::parse_number(fields[1])) return {Form::Kind::kNumbered};
  const auto first_of_matrix = fields.size() == 3 ? std::next(first) : first;
  if (first_of_matrix != lines.end() && first_of_matrix->fields.size() == 4) return {Form::Kind::kBlocks};
  if (fields.size() != kTumColumns - 1) return {};
  try {
    quaternion_pose(fields);
    return {Form::Kind::kNumbered};
  } catch (const std::invalid_argument&) {
    return {};
  }
}

/// Stamp as it is written, or the number of a pose without one; and pose.
struct Row {
  std::string stamp;
  Eigen::Isometry3d T_world_body;
};

Row stamped_row(Fields fields) {
  if (fields.size() == kAssociationColumns && !io::parse_number(fields[1])) fields = fields.last(kTumColumns);
  const std::string stamp = stamp_in_name(fields[0]);
  finite(stamp);
  const Fields pose = fields.subspan(1);
  if (fields.size() == kTumColumns) return {stamp, quaternion_pose(pose)};
  if (is_matrix(pose.size())) return {stamp, parse_matrix(pose)};
  throw std::invalid_argument(std::to_string(fields.size()) + " columns instead of 8 (stamp tx ty tz qx qy qz qw)");
}

Row euroc_row(Fields fields, const Form& form) {
  const std::size_t needed = std::ranges::max(form.columns) + 1;
  if (fields.size() < needed) {
    throw std::invalid_argument(std::to_string(fields.size()) + " columns instead of at least " +
                                std::to_string(needed) + " (time [ns], position, quaternion)");
  }
  std::vector<std::string> row;
  for (const std::size_t column : form.columns) row.push_back(fields[column]);
  if (row[0].find_first_not_of("0123456789") != std::string::npos)
    throw std::invalid_argument("'" + io::abridged(row[0]) + "' is not a stamp in nanoseconds");
  return stamped_row(row);
}

Eigen::Isometry3d numbered_pose(Fields fields) {
  if (fields.size() == kTumColumns - 1) return quaternion_pose(fields);
  if (is_matrix(fields.size())) return parse_matrix(fields);
  throw std::invalid_argument(std::to_string(fields.size()) + " numbers instead of 12 (the upper 3 x 4 of a pose)");
}

class RowReader {
 public:
  RowReader(const Form& form, const std::string& name) : form_(form), name_(name) {}

  void read(const io::TextLine& line) {
    try {
      take(line.fields);
    } catch (const NotFinite&) {
      ++not_finite;
    } catch (const std::invalid_argument& error) {
      if (!seen_ && is_title(line)) {
        titles += form_.kind == Form::Kind::kEuroc ? 0 : 1;  // that one was read
        places = 0;
      } else if (++broken == 1) {
        first_broken = name_ + ":" + std::to_string(line.number) + ": " + error.what();
      }
    }
    seen_ = true;
  }

  std::vector<Row> good;
  std::size_t places = 0;  ///< of poses without stamps, those that cannot be read too
  std::size_t titles = 0, not_finite = 0, broken = 0;
  std::string first_broken;

 private:
  void take(const std::vector<std::string>& fields) {
    if (form_.kind == Form::Kind::kStamped) return good.push_back(stamped_row(fields));
    if (form_.kind == Form::Kind::kEuroc) return good.push_back(euroc_row(fields, form_));
    if (form_.kind == Form::Kind::kNumbered) return add(fields);
    if (fields.size() == 3) return block_.clear();
    if (fields.size() != 4) throw std::invalid_argument(std::to_string(fields.size()) + " numbers instead of 4");
    block_.insert(block_.end(), fields.begin(), fields.end());
    if (block_.size() == kFullMatrixColumns) add(std::exchange(block_, {}));
  }
  void add(const std::vector<std::string>& pose) {
    const std::string place = std::to_string(places++);
    good.push_back({place, numbered_pose(pose)});
  }

  const Form& form_;
  const std::string& name_;
  std::vector<std::string> block_;
  bool seen_ = false;
};

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
  const std::vector<io::TextLine> lines = io::split_lines(text, kSeparators);
  const Form form = form_of(text, lines, name);
  RowReader rows(form, name);
  for (const io::TextLine& line : lines) rows.read(line);
  if (rows.good.empty() || rows.broken >= rows.good.size()) {
    if (!rows.first_broken.empty()) throw TrajectoryError(rows.first_broken);
    throw TrajectoryError(name + ": holds no poses" + (rows.not_finite > 0 ? ": all rows are nan" : ""));
  }
  PoseList list;
  list.places = rows.places;
  if (rows.titles > 0) list.notes.push_back(name + ": 1 title line without '#' left out");
  if (rows.not_finite > 0) list.notes.push_back(name + ": " + rows_text(rows.not_finite, "of nan left out"));
  if (rows.broken > 0)
    list.damages.push_back(rows_text(rows.broken, "that cannot be read, first: ") + rows.first_broken);
  const Unit unit = list.places > 0 || form.kind == Form::Kind::kEuroc ? Unit{9, "ns"} : unit_of(rows.good);
  if (unit.digits > 0 && form.kind == Form::Kind::kStamped)
    list.notes.push_back(name + ": its stamps are in " + unit.name);
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

bool give_stamps(PoseList& list, const std::vector<std::int64_t>& stamps_ns) {
  if (list.places != stamps_ns.size()) return false;
  for (StampedPose& pose : list.poses) pose.stamp_ns = stamps_ns[static_cast<std::size_t>(pose.stamp_ns)];
  return true;
}

}  // namespace rtd::geometry
