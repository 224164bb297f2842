// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/trajectory/pose_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <sstream>

#include "common/geometry/pose_list.hpp"
#include "common/io/recording_forms.hpp"
#include "common/mcap/recording_file.hpp"
#include "common/recordings/open.hpp"
#include "common/recordings/parts.hpp"
#include "common/recordings/reader.hpp"

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
  if (!given.times_file.empty()) {
    std::vector<std::int64_t> stamps_ns = geometry::read_frame_stamps(given.times_file);
    if (std::ranges::adjacent_find(stamps_ns, std::greater_equal()) != stamps_ns.end())
      throw TrajectoryError(given.times_file + ": its stamps do not rise");
    return stamps_ns;
  }
  const double rate_hz = given.rate_hz > 0 ? given.rate_hz : kNumberedHz;
  std::vector<std::int64_t> stamps_ns(poses);
  for (std::size_t i = 0; i < poses; ++i) stamps_ns[i] = std::llround(static_cast<double>(i) * 1e9 / rate_hz);
  return stamps_ns;
}

PoseFile read_text_file(const fs::path& path, const MissingStamps& given) {
  geometry::PoseList list = geometry::read_pose_list(path);
  PoseFile file;
  if (list.places > 0) {
    const std::vector<std::int64_t> stamps_ns = stamps_for(list.places, given);
    if (!geometry::give_stamps(list, stamps_ns))
      throw TrajectoryError(path.string() + ": has " + std::to_string(list.places) + " poses, but there are " +
                            std::to_string(stamps_ns.size()) + " stamps; name the times of this sequence");
    file.took_stamps = given.rate_hz > 0 || !given.times_file.empty();
    file.numbered = !file.took_stamps;
  }
  file.poses = std::move(list.poses);
  file.notes = std::move(list.notes);
  file.damages = std::move(list.damages);
  return file;
}

}  // namespace

PoseFile read_pose_file(const std::string& argument, const MissingStamps& stamps) {
  const PoseArgument wanted = parse(argument);
  std::error_code none;
  const bool exists = fs::exists(wanted.file, none);
  if (exists && is_recording(wanted.file))
    return read_recorded_poses(*recordings::open_reader(wanted.file), wanted.choice);
  if (wanted.chosen && exists)
    throw TrajectoryError(argument + ": topic and child are for recordings (bag, MCAP, .db3), the file is none");
  return read_text_file(wanted.file, stamps);
}

}  // namespace rtd::eval
