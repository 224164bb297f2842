// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/camera/source_uri.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <sstream>

#include "common/camera/frame_source.hpp"
#include "common/camera/source_schemes.hpp"
#include "common/camera/unread_forms.hpp"
#include "common/io/printable.hpp"
#include "common/io/recording_forms.hpp"
#include "common/io/text.hpp"
#include "common/recordings/parts.hpp"

namespace rtd::camera {

namespace {

/// Video nodes give depth that is not registered to colour, and no calibration that could register it.
void refuse_video_nodes(const std::string& text) {
  if (!text.starts_with("v4l2:")) return;
  throw SourceError("source '" + io::abridged(text) +
                    "': V4L2 cameras give no depth that is registered to colour; use the camera through openni2:, "
                    "realsense-dds: or its ROS 2 driver (ros2:COLOR,DEPTH)");
}

}  // namespace

SourceUri parse_source_uri(const std::string& text) {
  refuse_video_nodes(text);
  const std::size_t colon = text.find(':');
  if (const std::string advice = advice_for_file(text.substr(0, text.find('?'))); !advice.empty())
    throw SourceError(advice);
  if (colon == std::string::npos || colon == 0) {
    throw SourceError("source '" + io::abridged(text) + "' has no scheme; write " + all_source_forms());
  }
  SourceUri uri{text, text.substr(0, colon), text.substr(colon + 1), {}};
  const std::size_t question = uri.path.find('?');
  if (question == std::string::npos) return uri;
  std::istringstream parameters(uri.path.substr(question + 1));
  uri.path.resize(question);
  for (std::string part; std::getline(parameters, part, '&');) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw SourceError("source '" + io::abridged(text) + "': parameter '" + io::abridged(part) + "' is not key=value");
    }
    if (!uri.parameters.emplace(part.substr(0, equals), part.substr(equals + 1)).second) {
      throw SourceError("source '" + io::abridged(text) + "': parameter '" + io::abridged(part.substr(0, equals)) +
                        "' occurs twice");
    }
  }
  return uri;
}

std::int64_t parse_tolerance_ns(const std::string& uri, const std::string& value) {
  constexpr double kMaxMs = 1000;
  const std::optional<double> ms = io::parse_number(value);
  if (!ms || !(*ms > 0) || *ms > kMaxMs) {
    throw SourceError("source '" + io::abridged(uri) + "': tolerance_ms is '" + io::abridged(value) +
                      "', allowed: more than 0, at most 1000");
  }
  return static_cast<std::int64_t>(*ms * 1e6);
}

bool parse_flag(const std::string& uri, const std::string& key, const std::string& value) {
  if (value != "0" && value != "1") {
    throw SourceError("source '" + io::abridged(uri) + "': " + key + " is 0 or 1, not '" + io::abridged(value) + "'");
  }
  return value == "1";
}

namespace {

/// Lists of the form that tum: is named after.
bool has_tum_lists(const std::filesystem::path& folder) {
  std::error_code none;
  const auto has = [&](const char* list) { return std::filesystem::exists(folder / list, none); };
  return has("associations.txt") || (has("rgb.txt") && has("depth.txt"));
}

std::string folder_scheme(const std::filesystem::path& folder) {
  if (recordings::holds_recording(folder)) return "mcap:";
  return has_tum_lists(folder) ? "tum:" : "folder:";
}

}  // namespace

std::string complete_uri(const std::string& source) {
  const std::filesystem::path path = source.substr(0, source.find('?'));
  const bool has_scheme = path.string().find(':') != std::string::npos;
  if (has_scheme || !advice_for_file(path).empty()) return source;
  if (std::error_code none; std::filesystem::is_directory(path, none)) return folder_scheme(path) + source;
  if (io::is_packed_name(path)) return "mcap:" + source;
  const std::string extension = path.extension();
  if (extension.empty()) return source;
  const auto scheme = std::ranges::find(kSourceSchemes, extension, &SourceScheme::extension);
  return scheme == kSourceSchemes.end() ? source : std::string(scheme->name) + ':' + source;
}

}  // namespace rtd::camera
