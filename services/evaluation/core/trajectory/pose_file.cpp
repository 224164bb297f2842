// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/pose_file.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/io/recording_forms.hpp"
#include "common/io/text.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/recordings/open.hpp"
#include "common/recordings/parts.hpp"
#include "services/evaluation/core/trajectory/pose_text.hpp"
#include "services/evaluation/core/trajectory/recorded_poses.hpp"

namespace rtd::eval {
namespace {

namespace fs = std::filesystem;
using geometry::TrajectoryError;

/// FILE?topic=/x&child=FRAME, unless a file has the whole name.
struct PoseArgument {
  fs::path file;
  PoseChoice choice;
  bool chosen = false;
};

PoseArgument parse(const std::string& text) {
  if (fs::exists(text)) return {text, {}, false};
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
    if (fs::is_directory(file)) return recordings::holds_recording(file);
    return recordings::is_recording(file.string()) || io::is_recording_name(file);
  } catch (const mcap::RecordingFileError&) {
    return false;  // read_text_file() says why it cannot be read
  }
}

std::vector<std::int64_t> stamps_for(const std::string& name, std::size_t poses, const MissingStamps& given) {
  if (!given.times_file.empty()) return geometry::read_frame_stamps(given.times_file);
  if (given.rate_hz <= 0) {
    throw TrajectoryError(name +
                          ": KITTI's format (12 numbers a line) has no stamps; give --times FILE (a stamp in seconds a "
                          "line, as times.txt of the sequence) or --rate HZ");
  }
  std::vector<std::int64_t> stamps_ns(poses);
  for (std::size_t i = 0; i < poses; ++i) stamps_ns[i] = std::llround(static_cast<double>(i) * 1e9 / given.rate_hz);
  return stamps_ns;
}

PoseFile read_text_file(const fs::path& file, const MissingStamps& stamps) {
  const std::string name = file.string();
  const std::optional<std::string> text = fs::is_regular_file(file) ? io::read_text(file) : std::nullopt;
  const PoseFormat format = text ? format_of(*text) : PoseFormat::kTum;
  if (format == PoseFormat::kEuroc) return {read_euroc(*text, name), false, {}};
  if (format == PoseFormat::kKitti)
    return {read_kitti(*text, name, stamps_for(name, count_kitti(*text), stamps)), true, {}};
  return {geometry::read_tum_trajectory(file), false, {}};  // says what is wrong with a file that cannot be read
}

}  // namespace

PoseFile read_pose_file(const std::string& argument, const MissingStamps& stamps) {
  const PoseArgument wanted = parse(argument);
  if (fs::exists(wanted.file) && is_recording(wanted.file)) {
    RecordedPoses recorded = read_recorded_poses(*camera::open_any(wanted.file), wanted.choice);
    return {std::move(recorded.poses), false, std::move(recorded.damages)};
  }
  if (wanted.chosen && fs::exists(wanted.file))
    throw TrajectoryError(argument + ": topic and child are for recordings (bag, MCAP, .db3), the file is none");
  return read_text_file(wanted.file, stamps);
}

}  // namespace rtd::eval
